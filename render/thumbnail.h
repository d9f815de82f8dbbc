#pragma once

#include "render/image.h"

namespace rebake {

/// Crops the centre of an image to the aspect ratio of `width` × `height`, and downsamples it to that size with a box
/// filter. Never enlarges: smaller images are at most cropped.
Image thumbnail_of(const Image& image, int width, int height);

}  // namespace rebake
