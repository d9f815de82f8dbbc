#pragma once

#include <filesystem>

#include "mesh_ops/scene/light.h"

namespace rebake {

/// Reads the light of an equirectangular picture of all directions (2 : 1; OpenEXR, Radiance HDR, PNG, JPEG, TIFF,
/// WebP): its middle lies towards −z, its right quarter towards +x, its upper edge at +y. Alpha is passed over. Whole
/// numbers that do not say they are linear are display colours (IEC 61966-2-1). The sky keeps 64² directions; what is
/// thirty times as bright as the rest within a few degrees and sends 1/200 of all light becomes a sun, at most four,
/// since rays would miss it. Throws FileError.
LightPicture read_light_picture(const std::filesystem::path& path);

}  // namespace rebake
