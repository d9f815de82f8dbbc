#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// For each face of a set, 1 if it may show an opaque texel under nearest sampling, else 0. Errs on the side of 1:
/// texels within one texel of the triangle count as touched, and faces with UVs outside [0, 1] are not looked at.
std::vector<std::uint8_t> faces_with_opaque_texels(const TextureSet& set);

}  // namespace rebake
