#include "mesh_ops/base/processor.h"
#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cage_coordinates/row_sums.h"

namespace rebake {

std::size_t batch_workspace(const BatchCage& cage, bool gradients) {
  return (gradients ? 4U : 1U) * batch_lanes * (cage.edge_count + cage.vertex_count) + batch_lanes;
}

std::size_t batch_sums_at(const BatchCage& cage, bool gradients) {
  return (gradients ? 4U : 1U) * batch_lanes * cage.edge_count;
}

std::vector<MeanValueBatch> mean_value_batches() {
  std::vector<MeanValueBatch> batches;
#ifdef REBAKE_WIDE_VECTORS
  if (processor_has_v4()) batches.push_back(mean_value_batch_v4);
  if (processor_has_v3()) batches.push_back(mean_value_batch_v3);
#endif
  batches.push_back(mean_value_batch_baseline);
  return batches;
}

RowSums row_sums() {
#ifdef REBAKE_WIDE_VECTORS
  if (processor_has_v4()) return row_sums_v4;
  if (processor_has_v3()) return row_sums_v3;
#endif
  return row_sums_baseline;
}

}  // namespace rebake
