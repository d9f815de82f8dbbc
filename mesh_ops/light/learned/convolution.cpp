// Compiled once per instruction set (mesh_ops/CMakeLists.txt).
#include "mesh_ops/light/learned/convolution.h"

#include <cstring>

#ifndef REBAKE_CONVOLVE_NAME
#define REBAKE_CONVOLVE_NAME convolve_row_baseline
#endif

namespace rebake {

namespace {

using Vector = float __attribute__((vector_size(convolution_lanes * sizeof(float))));
constexpr int lanes = convolution_lanes;

}  // namespace

void REBAKE_CONVOLVE_NAME(const Convolution& convolution, const float* input, PlaneLayout layout, int width, int row,
                          int block, float* result) {
  const int reach = convolution.kernel / 2;
  const std::size_t taps = static_cast<std::size_t>(convolution.kernel * convolution.kernel);
  const float* weights = convolution.weights +
                         static_cast<std::size_t>(block) * static_cast<std::size_t>(convolution.inputs) * taps * lanes;
  for (int x = 0; x < width; x += lanes) {
    // One vector of sums per output plane of the block; its lanes are adjacent columns.
    Vector sums[lanes];
    for (int o = 0; o < lanes; ++o) sums[o] = Vector{} + convolution.bias[block * lanes + o];
    const float* w = weights;
    for (int i = 0; i < convolution.inputs; ++i)
      for (int dy = -reach; dy <= reach; ++dy) {
        const float* at = input + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * layout.plane) +
                          (row + dy) * static_cast<std::ptrdiff_t>(layout.pitch) + x;
        for (int dx = -reach; dx <= reach; ++dx, w += lanes) {
          Vector values;
          std::memcpy(&values, at + dx, sizeof values);  // unaligned load
          for (int o = 0; o < lanes; ++o) sums[o] += w[o] * values;
        }
      }
    for (int o = 0; o < lanes; ++o) std::memcpy(result + o * width + x, &sums[o], sizeof sums[o]);
  }
}

}  // namespace rebake
