#pragma once

#include <string>
#include <vector>

#include "editor/edits/edit.h"

namespace rebake {

/// What a step of history did, as a sentence for people: "Selected 313 triangles in ficus". `group` is what was made
/// together, `before` and `after` the scenes around it; `replaced` the edit that the first one is a revision of, or
/// null.
std::string title_of(const std::vector<Edit>& group, const Scene& before, const Scene& after,
                     const Edit* replaced = nullptr);
/// The same where only the scene of some time later is at hand: without amounts.
std::string title_of(const std::vector<Edit>& group, const Scene& later);

}  // namespace rebake
