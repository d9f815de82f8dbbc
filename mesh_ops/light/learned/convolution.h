#pragma once

#include <cstddef>

// Convolutions of a small network over planes of floats. Plain arrays only: the implementation is also compiled for
// newer processors and must share no inline function with other files. All implementations give the same bits.

namespace rebake {

inline constexpr int convolution_lanes = 8;

/// Planes with a zero border: one value before each row, at least convolution_lanes values after it.
struct PlaneLayout {
  std::size_t pitch, plane;  ///< floats per row and per plane, with borders
};

struct Convolution {
  int inputs, outputs;   ///< numbers of planes; outputs is a multiple of convolution_lanes
  int kernel;            ///< width: 1 or 3
  const float* weights;  ///< [output / lanes][input][row of the kernel][column][lane]
  const float* bias;     ///< per output plane
};

/// Computes row `row` of the output planes [block · lanes, block · lanes + lanes), `width` columns (a multiple of
/// lanes): weighted sums plus bias, without a nonlinearity. `input` points to the first value of the first plane inside
/// its border; `result` has lanes rows of `width` values.
using ConvolveRow = void (*)(const Convolution& convolution, const float* input, PlaneLayout layout, int width, int row,
                             int block, float* result);

void convolve_row_baseline(const Convolution&, const float*, PlaneLayout, int, int, int, float*);
#ifdef REBAKE_WIDE_VECTORS
void convolve_row_v3(const Convolution&, const float*, PlaneLayout, int, int, int, float*);
#endif

}  // namespace rebake
