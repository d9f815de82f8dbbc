#include "mesh_ops/deform/mean_value_batch.h"
#include "mesh_ops/deform/row_sums.h"

namespace rebake {

std::size_t batch_workspace(const BatchCage& cage, bool gradients) {
  return (gradients ? 4U : 1U) * batch_lanes * (cage.edge_count + cage.vertex_count);
}

MeanValueBatch mean_value_batch() {
#ifdef REBAKE_WIDE_VECTORS
  if (__builtin_cpu_supports("x86-64-v4")) return mean_value_batch_v4;
  if (__builtin_cpu_supports("x86-64-v3")) return mean_value_batch_v3;
#endif
  return mean_value_batch_baseline;
}

RowSums row_sums() {
#ifdef REBAKE_WIDE_VECTORS
  if (__builtin_cpu_supports("x86-64-v4")) return row_sums_v4;
  if (__builtin_cpu_supports("x86-64-v3")) return row_sums_v3;
#endif
  return row_sums_baseline;
}

}  // namespace rebake
