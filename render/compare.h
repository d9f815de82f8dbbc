#pragma once

#include "render/image.h"

namespace rebake {

/// Error metrics of two pictures of the same size.
struct Difference {
  double psnr_db = 0;       ///< peak signal-to-noise ratio over all channels; infinity for equal pictures
  double ssim = 1;          ///< mean structural similarity of luma (Wang et al. 2004: Gaussian window, σ 1.5)
  int largest = 0;          ///< largest difference of a channel, 0 … 255
  int x = 0, y = 0;         ///< first pixel with that difference in row order, from the top left
  double share_beyond = 0;  ///< share of pixels, 0 … 1, with a channel that differs by more than the tolerance
};

/// Structural similarity per pixel, see Difference::ssim. Both pictures have the same size.
std::vector<double> ssim_map(const Image& a, const Image& b);

/// Compares two pictures; `tolerance` is in 1/255. Throws Error if their sizes differ.
Difference compare(const Image& a, const Image& b, int tolerance);

}  // namespace rebake
