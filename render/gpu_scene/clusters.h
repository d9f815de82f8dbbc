#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/mesh/soup.h"

namespace rebake {

/// Numbers of faces, those that lie close together one after the other.
using NearbyOrder = std::shared_ptr<const std::vector<std::uint32_t>>;

/// Most faces of a FaceCluster. On the mic's 82,421 triangles clusters of 64 leave 46,000 to be looked at one by one,
/// clusters of 256 60,000; below 64 looking at clusters costs what it spares.
inline constexpr std::size_t faces_a_face_cluster = 64;

/// [first, first + count) of an order, and the box of these faces in object space.
struct FaceCluster {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  Box bounds;
};

/// Where a cluster's triangles lie, so that all of them are looked at in one sweep: [corner][axis][face], as the floats
/// that are drawn. Behind the cluster's last face that one stands again.
struct ClusterCorners {
  float at[3][3][faces_a_face_cluster];
};

/// Faces along a curve through their middles (Morton order, meshoptimizer).
NearbyOrder nearby_order(const Soup& soup, const std::vector<Face>& faces);

struct FaceClusters {
  std::vector<FaceCluster> clusters;
  std::vector<ClusterCorners> corners;
};
/// The order cut into clusters; corners are relative to `center`.
FaceClusters face_clusters(const Soup& soup, const std::vector<Face>& faces, const std::vector<std::uint32_t>& order,
                           const Vec3& center);

}  // namespace rebake
