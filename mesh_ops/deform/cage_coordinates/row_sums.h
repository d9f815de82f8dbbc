#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh_ops/deform/cage_coordinates/mean_value_batch.h"

namespace rebake {

/// Weighted sums of motions over `count` rows of a block, per lane:
///
///     sums[to][axis][lane] = Σ_k motions[k][to] · block[rows[k]][axis][lane]
///
/// `axes` is 1 (for weights) or 3 (for gradients). Each [lane] row has batch_lanes floats.
using RowSums = void (*)(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                         std::size_t axes, float* sums);

/// The fastest implementation that this processor can run.
RowSums row_sums();

// One source file, compiled once per processor level.
void row_sums_baseline(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                       std::size_t axes, float* sums);
#ifdef REBAKE_WIDE_VECTORS
void row_sums_v3(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                 std::size_t axes, float* sums);
void row_sums_v4(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                 std::size_t axes, float* sums);
#endif

}  // namespace rebake
