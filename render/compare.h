#pragma once

#include "render/image.h"

namespace rebake {

/// How much two pictures of one size differ.
struct Difference {
  double psnr_db = 0;       ///< over all channels; infinity for equal pictures
  double ssim = 1;          ///< mean structural similarity of luma (Wang et al. 2004: Gaussian window, σ 1.5)
  int largest = 0;          ///< largest difference of a channel, 0 … 255
  int x = 0, y = 0;         ///< the first pixel that has it, from the top left
  double share_beyond = 0;  ///< share of pixels with a channel further apart than the tolerance
};

/// Throws Error when sizes differ. `tolerance` in 1/255.
Difference compare(const Image& a, const Image& b, int tolerance);

}  // namespace rebake
