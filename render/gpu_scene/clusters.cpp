#include "render/gpu_scene/clusters.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace rebake {

SpatialOrder spatial_order(const Soup& soup, const std::vector<Face>& faces) {
  std::vector<std::uint32_t> order(faces.size());
  if (faces.size() <= max_faces_per_cluster) {
    std::iota(order.begin(), order.end(), 0U);
    return std::make_shared<const std::vector<std::uint32_t>>(std::move(order));
  }
  // Relative to the first corner, so that floats are precise enough far from the origin.
  const Vec3 origin = soup.positions()[faces[0][0]];
  std::vector<Eigen::Vector3f> middles(faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t f) {
    Vec3 sum = Vec3::Zero();
    for (const std::uint32_t vertex : faces[f]) sum += soup.positions()[vertex] - origin;
    // A face with a NaN or infinite position may be anywhere in the order.
    middles[f] = sum.allFinite() ? Eigen::Vector3f((sum / 3).cast<float>()) : Eigen::Vector3f::Zero();
  });
  std::vector<unsigned> place(faces.size());
  meshopt_spatialSortRemap(place.data(), middles[0].data(), middles.size(), sizeof(middles[0]));
  for (std::size_t f = 0; f < faces.size(); ++f) order[place[f]] = static_cast<std::uint32_t>(f);
  return std::make_shared<const std::vector<std::uint32_t>>(std::move(order));
}

FaceClusters face_clusters(const Soup& soup, const std::vector<Face>& faces, const std::vector<std::uint32_t>& order,
                           const Vec3& center) {
  FaceClusters made;
  made.clusters.resize((order.size() + max_faces_per_cluster - 1) / max_faces_per_cluster);
  made.corners.resize(made.clusters.size());
  tbb::parallel_for(std::size_t{0}, made.clusters.size(), [&](std::size_t k) {
    const std::size_t first = k * max_faces_per_cluster, count = std::min(max_faces_per_cluster, order.size() - first);
    FaceCluster cluster{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), {}};
    for (std::size_t i = 0; i < max_faces_per_cluster; ++i) {
      const Face& face = faces[order[first + std::min(i, count - 1)]];
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3& position = soup.positions()[face[c]];
        cluster.bounds.extend(position);
        const Eigen::Vector3f relative = (position - center).cast<float>();
        for (std::size_t axis = 0; axis < 3; ++axis)
          made.corners[k].at[c][axis][i] = relative[static_cast<Eigen::Index>(axis)];
      }
    }
    made.clusters[k] = cluster;
  });
  return made;
}

}  // namespace rebake
