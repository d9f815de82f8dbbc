#pragma once

#include <memory>

#include "mesh_ops/base/result_cache.h"

namespace rebake {

/// The process-wide cache of expensive results; null: no cache. Set it once, before the first edit.
void set_result_cache(std::shared_ptr<ResultCache> results);
std::shared_ptr<ResultCache> result_cache();

}  // namespace rebake
