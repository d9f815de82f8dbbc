#pragma once

#include "mesh_ops/light/lighting.h"

namespace rebake {

/// Light corrections of a scene, by lighting_of() with the cache result_cache(); empty if Scene::light is null.
/// `everything`: also effects that the scene does not call for.
Lighting lit(const Scene& scene, const Progress& progress = {}, bool everything = false);

}  // namespace rebake
