// The inner loop of dragging. It is limited by memory bandwidth (reading weights) if the sums stay in vector registers.
#include "mesh_ops/deform/cage_coordinates/row_sums.h"

#ifndef REBAKE_ROW_SUMS_NAME
#define REBAKE_ROW_SUMS_NAME row_sums_baseline
#endif

namespace rebake {

namespace {

constexpr int lanes = static_cast<int>(batch_lanes);

template <int axes>
void add_up(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count, float* result) {
  float sums[3 * axes][lanes] = {};
  for (std::size_t k = 0; k < count; ++k) {
    const float* row = block + static_cast<std::size_t>(rows[k]) * axes * batch_lanes;
    const float mx = motions[3 * k], my = motions[3 * k + 1], mz = motions[3 * k + 2];
    for (int axis = 0; axis < axes; ++axis)
#pragma omp simd
      for (int lane = 0; lane < lanes; ++lane) {
        const float weight = row[axis * lanes + lane];
        sums[axis][lane] += weight * mx;
        sums[axes + axis][lane] += weight * my;
        sums[2 * axes + axis][lane] += weight * mz;
      }
  }
  for (int i = 0; i < 3 * axes; ++i)
    for (int lane = 0; lane < lanes; ++lane) result[i * lanes + lane] = sums[i][lane];
}

}  // namespace

void REBAKE_ROW_SUMS_NAME(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                          std::size_t axes, float* sums) {
  if (axes == 1)
    add_up<1>(block, rows, motions, count, sums);
  else
    add_up<3>(block, rows, motions, count, sums);
}

}  // namespace rebake
