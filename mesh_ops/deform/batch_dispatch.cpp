#include "mesh_ops/deform/coordinates.h"
#include "mesh_ops/deform/row_sums.h"

namespace rebake {

#ifdef REBAKE_WIDE_VECTORS
namespace {

// What the levels of the x86-64 psABI add; the few features not asked for come with these.
bool has_v3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
bool has_v4() {
  return has_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

}  // namespace
#endif

std::size_t batch_workspace(const BatchCage& cage, bool gradients) {
  return (gradients ? 4U : 1U) * batch_lanes * (cage.edge_count + cage.vertex_count);
}

std::size_t batch_sums_at(const BatchCage& cage, bool gradients) {
  return (gradients ? 4U : 1U) * batch_lanes * cage.edge_count;
}

std::vector<MeanValueBatch> mean_value_batches() {
  std::vector<MeanValueBatch> batches;
#ifdef REBAKE_WIDE_VECTORS
  if (has_v4()) batches.push_back(mean_value_batch_v4);
  if (has_v3()) batches.push_back(mean_value_batch_v3);
#endif
  batches.push_back(mean_value_batch_baseline);
  return batches;
}

RowSums row_sums() {
#ifdef REBAKE_WIDE_VECTORS
  if (has_v4()) return row_sums_v4;
  if (has_v3()) return row_sums_v3;
#endif
  return row_sums_baseline;
}

}  // namespace rebake
