#pragma once

#include <filesystem>
#include <functional>

#include "mesh_ops/scene/scene_light.h"

namespace rebake::test {

/// Writes an equirectangular picture of `width` × `width` / 2 pixels: `radiance` is linear for .exr, otherwise in
/// display colours. The centre is −z, right is +x, up is +y. Its formula for directions does not share code with the
/// reader.
void write_light_picture(const std::filesystem::path& path, int width,
                         const std::function<Radiance(const Vec3&)>& radiance);

}  // namespace rebake::test
