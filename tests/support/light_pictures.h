#pragma once

#include <filesystem>
#include <functional>

#include "mesh_ops/scene/light.h"

namespace rebake::test {

/// Writes an equirectangular picture of what lies in each direction, of the kind that its name says: linear radiances
/// as OpenEXR, else display colours. Directions by their own formula: the middle is −z, to the right +x, above +y.
void write_light_picture(const std::filesystem::path& path, int width,
                         const std::function<Radiance(const Vec3&)>& radiance);

}  // namespace rebake::test
