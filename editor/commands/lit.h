#pragma once

#include "mesh_ops/light/lighting.h"

namespace rebake {

/// What light does to a scene as it is, with what was traced before; nothing where the scene has no light that follows.
/// `everything`: also what it does not call for.
Lighting lit(const Scene& scene, const Progress& progress = {}, bool everything = false);

}  // namespace rebake
