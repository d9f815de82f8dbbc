#pragma once

#include <filesystem>

#include "mesh_ops/scene/scene_light.h"

namespace rebake {

/// Reads an environment map: an equirectangular image (2 : 1; OpenEXR, Radiance HDR, PNG, JPEG, TIFF, WebP). Its centre
/// lies towards −z, its right quarter towards +x, its upper edge at +y. Alpha is ignored. Integer channels are display
/// colours (IEC 61966-2-1) unless the file calls them linear; floating-point channels are linear unless marked sRGB.
/// The sky becomes an octahedral map of 64² texels. Up to four bright spots (radius up to 0.1 radians) become suns,
/// since rays would miss them. A spot must be thirty times as bright as the mean outside it and send at least 1/200 of
/// all light. Throws FileError.
LightPicture read_environment_map(const std::filesystem::path& path);

}  // namespace rebake
