#include "editor/actions/lit.h"

#include "editor/edits/shared_result_cache.h"

namespace rebake {

Lighting lit(const Scene& scene, const Progress& progress, bool everything) {
  if (!scene.light) return {};
  LightingOptions options;
  const std::shared_ptr<ResultCache> results = result_cache();
  options.results = results.get();
  options.everything = everything;
  return lighting_of(scene, options, progress);
}

}  // namespace rebake
