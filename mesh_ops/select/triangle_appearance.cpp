#include "mesh_ops/select/triangle_appearance.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

using Features = Eigen::Array<double, 8, 1>;

Features features_of(const TriangleTraits& traits) {
  return Eigen::Map<const Eigen::Array<float, 8, 1>>(traits.features.data()).cast<double>();
}
Vec3 vector_of(const std::array<float, 3>& v) { return Vec3(v[0], v[1], v[2]); }

// Transforms areas and normals of triangles to world space.
class WorldShape {
 public:
  explicit WorldShape(const PlacedNode& placed)
      : cofactor_(placed.to_world.linear().determinant() * placed.to_world.linear().inverse().transpose()) {}
  // Area vector in world space: normal times area.
  Vec3 area(const TriangleTraits& traits) const { return cofactor_ * vector_of(traits.normal) * traits.area; }

 private:
  Mat3 cofactor_;
};

}  // namespace

TriangleAppearance mean_appearance(const std::vector<PlacedNode>& objects, const std::vector<TriangleSet>& picked) {
  TriangleAppearance mean;
  double total = 0, opaque = 0;
  // The sign of normals is ignored: the mean axis is the eigenvector with the largest eigenvalue of the sum of their
  // outer products.
  Mat3 planes = Mat3::Zero();
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (count(picked[k]) == 0) continue;
    const auto traits = traits_of(*objects[k].node->object);
    const WorldShape shape(objects[k]);
    for (std::size_t f = 0; f < picked[k].size(); ++f) {
      if (picked[k][f] == 0) continue;
      const TriangleTraits& t = (*traits)[f];
      const Vec3 area = shape.area(t);
      // Fully transparent triangles have no colour and no features.
      if (t.opacity > 0) {
        mean.color += vector_of(t.color);
        mean.features += features_of(t);
        opaque += 1;
      }
      mean.opacity += static_cast<double>(t.opacity);
      mean.area += area.norm();
      const Vec3 normal = area.stableNormalized();
      planes += normal * normal.transpose();
      total += 1;
    }
  }
  mean.color /= std::max(opaque, 1.0);
  mean.features /= std::max(opaque, 1.0);
  mean.opacity /= total;
  mean.area /= total;
  mean.normal = Eigen::SelfAdjointEigenSolver<Mat3>(planes).eigenvectors().col(2);
  return mean;
}

TriangleSet triangles_like(const PlacedNode& placed, const TriangleAppearance& model, const AppearanceBounds& bounds) {
  // Sines are exact for equal planes, up to the rounding of the normals, which are floats.
  constexpr double rounding = 4.0 * std::numeric_limits<float>::epsilon();
  const double max_sine = bounds.orientation && *bounds.orientation < 90
                              ? elementary::sine_cosine(*bounds.orientation * std::numbers::pi / 180).sine + rounding
                              : 2;
  const auto traits = traits_of(*placed.node->object);
  const WorldShape shape(placed);
  TriangleSet flags(traits->size());
  tbb::parallel_for(std::size_t{0}, flags.size(), [&](std::size_t f) {
    const TriangleTraits& t = (*traits)[f];
    if ((bounds.color || bounds.features) && t.opacity == 0) return;
    if (bounds.color && (vector_of(t.color) - model.color).norm() > *bounds.color) return;
    if (bounds.features && std::sqrt((features_of(t) - model.features).square().mean()) > *bounds.features) return;
    if (bounds.opacity && std::abs(static_cast<double>(t.opacity) - model.opacity) > *bounds.opacity) return;
    if (bounds.size || bounds.orientation) {
      const Vec3 area = shape.area(t);
      // Copies differ by the rounding of areas and normals, which are floats.
      constexpr double room = 1 + rounding;
      if (bounds.size &&
          (area.norm() > room * model.area * *bounds.size || room * area.norm() * *bounds.size < model.area))
        return;
      const Vec3 normal = area.stableNormalized();
      if (bounds.orientation && (normal.isZero(0) || normal.cross(model.normal).norm() > max_sine)) return;
    }
    flags[f] = 1;
  });
  return flags;
}

}  // namespace rebake
