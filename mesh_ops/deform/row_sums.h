#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh_ops/deform/mean_value_batch.h"

namespace rebake {

/// Rows of weights times motions: sums[to][axis][lane] = Σ over `count` rows of motions[row][to] · the row's
/// numbers[axis][lane], for `axes` (1 or 3) rows of batch_lanes floats each. `rows` says which rows of the block.
using RowSums = void (*)(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                         std::size_t axes, float* sums);

/// The implementation for this machine's processor.
RowSums row_sums();

// One source, compiled once for each kind of processor.
void row_sums_baseline(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                       std::size_t axes, float* sums);
#ifdef REBAKE_WIDE_VECTORS
void row_sums_v3(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                 std::size_t axes, float* sums);
void row_sums_v4(const float* block, const std::uint32_t* rows, const float* motions, std::size_t count,
                 std::size_t axes, float* sums);
#endif

}  // namespace rebake
