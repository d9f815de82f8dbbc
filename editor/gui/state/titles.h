#pragma once

#include <string>
#include <vector>

#include "editor/edits/edit.h"

namespace rebake {

/// Title of a step of history: "Selected 313 triangles in ficus". `group`: the edits of the step; `before`, `after`:
/// the scenes around it; `replaced`: the edit that the first one revises, or null.
std::string title_of(const std::vector<Edit>& group, const Scene& before, const Scene& after,
                     const Edit* replaced = nullptr);
/// A title without numbers of triangles, if only a later scene is available.
std::string title_of(const std::vector<Edit>& group, const Scene& later);

}  // namespace rebake
