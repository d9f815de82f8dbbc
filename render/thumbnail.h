#pragma once

#include "render/image.h"

namespace rebake {

/// The middle of an image in the shape of `width` × `height`, averaged over each of those pixels; never enlarged.
Image thumbnail_of(const Image& image, int width, int height);

}  // namespace rebake
