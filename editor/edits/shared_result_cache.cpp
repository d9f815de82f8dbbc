#include "editor/edits/shared_result_cache.h"

#include <utility>

namespace rebake {

namespace {

std::shared_ptr<ResultCache>& place() {
  static std::shared_ptr<ResultCache> results;
  return results;
}

}  // namespace

void set_result_cache(std::shared_ptr<ResultCache> results) { place() = std::move(results); }

std::shared_ptr<ResultCache> result_cache() { return place(); }

}  // namespace rebake
