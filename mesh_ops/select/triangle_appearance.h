#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Mean appearance and shape of triangles, in world space.
struct TriangleAppearance {
  Vec3 color = Vec3::Zero();  ///< decoded display colour, 0 … 1 per channel
  Eigen::Array<double, 8, 1> features = Eigen::Array<double, 8, 1>::Zero();  ///< decoded features, 0 … 1
  double opacity = 0;                                                        ///< share of opaque texels, 0 … 1
  double area = 0;                                                           ///< square world units
  Vec3 normal = Vec3::Zero();  ///< unit axis closest to all normals; its sign has no meaning
};

/// Mean over the flagged triangles of placed objects. `picked`: flags per object; at least one triangle must be
/// flagged.
TriangleAppearance mean_appearance(const std::vector<PlacedNode>& objects, const std::vector<TriangleSet>& picked);

/// Largest differences from a TriangleAppearance; bounds without a value are ignored.
struct AppearanceBounds {
  std::optional<double> color;        ///< distance of mean decoded colours in RGB, 0 … 1 per channel
  std::optional<double> features;     ///< root mean square difference of mean features
  std::optional<double> opacity;      ///< difference of the shares of opaque texels
  std::optional<double> size;         ///< ratio of the larger to the smaller area, at least 1
  std::optional<double> orientation;  ///< angle between planes in degrees, 0 … 90
};

/// Triangles within all bounds. Fully transparent triangles match no bound on colour or features.
TriangleSet triangles_like(const PlacedNode& placed, const TriangleAppearance& model, const AppearanceBounds& bounds);

}  // namespace rebake
