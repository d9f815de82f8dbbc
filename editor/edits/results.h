#pragma once

#include <memory>

#include "mesh_ops/base/results.h"

namespace rebake {

/// Where this program keeps them, null for nowhere: set once, before the first edit.
void keep_results_in(std::shared_ptr<Results> results);
std::shared_ptr<Results> kept_results();

}  // namespace rebake
