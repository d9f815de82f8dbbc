#pragma once

#include <cstddef>

// Convolutions of a small network over planes of floats. Plain arrays: this crosses into a file that is compiled for
// newer processors too, which must share no inline function with any other. Every implementation gives the same bits.

namespace rebake {

inline constexpr int convolution_lanes = 8;

/// Planes with a border of zeros, one wide before and at least convolution_lanes wide behind each row.
struct PlaneLayout {
  std::size_t pitch, plane;  ///< floats a row and a plane, borders included
};

struct Convolution {
  int inputs, outputs;   ///< planes; outputs a multiple of convolution_lanes
  int kernel;            ///< 1 or 3: its width
  const float* weights;  ///< [output / lanes][input][row of the kernel][column][lane]
  const float* bias;     ///< of each output
};

/// Row `row` of the outputs from `block` · lanes on, of `width` (a multiple of lanes) columns: sums and bias, without
/// any nonlinearity. `input` points to the first plane's first value inside its border; `result`: lanes rows of
/// `width`.
using ConvolveRow = void (*)(const Convolution& convolution, const float* input, PlaneLayout layout, int width, int row,
                             int block, float* result);

void convolve_row_baseline(const Convolution&, const float*, PlaneLayout, int, int, int, float*);
#ifdef REBAKE_WIDE_VECTORS
void convolve_row_v3(const Convolution&, const float*, PlaneLayout, int, int, int, float*);
#endif

}  // namespace rebake
