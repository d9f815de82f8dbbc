#pragma once

#include <memory>

#include "mesh_ops/base/results.h"

namespace rebake {

/// The process-wide cache of expensive results; null: no cache. Set it once, before the first edit.
void keep_results_in(std::shared_ptr<Results> results);
std::shared_ptr<Results> kept_results();

}  // namespace rebake
