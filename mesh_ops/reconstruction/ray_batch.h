#pragma once

#include <vector>

#include "mesh_ops/reconstruction/compositing.h"
#include "mesh_ops/reconstruction/free_grid.h"
#include "mesh_ops/reconstruction/scene_field.h"
#include "mesh_ops/reconstruction/training_views.h"

namespace rebake {

/// Rays with their hits on the grid (and the nested boxes), sorted along each ray.
struct RayBatch {
  std::vector<TrainingRay> rays;
  std::vector<std::size_t> first;  ///< per ray, and once more: index of its first hit
  std::vector<GridHit> hits;
  std::vector<FieldPoint> points;            ///< per hit: where the fields are evaluated
  std::vector<std::array<double, 3>> along;  ///< per hit: derivative of its point by t
  std::vector<double> lengths;               ///< per hit: length of the ray from its first hit, in the fields' space
  std::vector<float> opacities;              ///< per hit

  /// Finds the hits of all rays, at most `most` per ray.
  void find_hits(const FreeGrid& grid, const std::vector<std::uint8_t>& active, std::size_t most);
  /// Adds to `position_slopes` (per vertex) the derivatives of the loss for those by the hits' points.
  void add_position_slopes(const std::vector<FieldPoint>& point_slopes, std::vector<Vec3>& position_slopes) const;
};

}  // namespace rebake
