#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Per face of a set: 1 if it may show an opaque texel under nearest sampling, else 0. Conservative: texels within one
/// texel of the triangle count, and faces with UVs outside [0, 1] are always 1.
std::vector<std::uint8_t> faces_with_opaque_texels(const TextureSet& set);

}  // namespace rebake
