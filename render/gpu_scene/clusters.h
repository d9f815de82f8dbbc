#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/mesh/soup.h"

namespace rebake {

/// Permutation of face indices in which nearby faces follow each other.
using SpatialOrder = std::shared_ptr<const std::vector<std::uint32_t>>;

/// Maximum number of faces of a FaceCluster. Of the mic's 82,421 triangles, clusters of 64 leave 46,000 to be tested
/// one by one, clusters of 256 leave 60,000. Below 64, testing more clusters costs as much as it saves.
inline constexpr std::size_t max_faces_per_cluster = 64;

/// A range [first, first + count) of a SpatialOrder, with the bounding box of its faces in object space.
struct FaceCluster {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  Box bounds;
};

/// Corner positions of a cluster's faces, laid out for SIMD: [corner][axis][face], with the same floats as on the GPU.
/// Slots after the last face repeat it.
struct ClusterCorners {
  float at[3][3][max_faces_per_cluster];
};

/// Sorts faces by their centroids along a space-filling curve (Morton order, meshoptimizer).
SpatialOrder spatial_order(const Soup& soup, const std::vector<Face>& faces);

struct FaceClusters {
  std::vector<FaceCluster> clusters;
  std::vector<ClusterCorners> corners;  ///< per cluster
};
/// Cuts an order into clusters. Corners are relative to `center`.
FaceClusters face_clusters(const Soup& soup, const std::vector<Face>& faces, const std::vector<std::uint32_t>& order,
                           const Vec3& center);

}  // namespace rebake
