#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// What triangles look like in the world, on average.
struct Likeness {
  Vec3 color = Vec3::Zero();                                                 ///< decoded, channels 0 … 1
  Eigen::Array<double, 8, 1> features = Eigen::Array<double, 8, 1>::Zero();  ///< 0 … 1
  double opacity = 0;                                                        ///< share of opaque texels
  double area = 0;                                                           ///< in square units of the world
  Vec3 normal = Vec3::Zero();  ///< unit, of no sign: the axis that their planes agree on best
};

/// Of the flagged triangles of placed objects, one set an object; at least one is flagged.
Likeness mean_likeness(const std::vector<PlacedNode>& objects, const std::vector<TriangleSet>& picked);

/// How far triangles may be from a likeness; what is not given is not looked at.
struct LikenessBounds {
  std::optional<double> color;        ///< distance of mean decoded colours, channels 0 … 1
  std::optional<double> features;     ///< root mean square difference of mean features
  std::optional<double> opacity;      ///< difference of the share of opaque texels
  std::optional<double> size;         ///< factor between areas, at least 1
  std::optional<double> orientation;  ///< degrees between planes, 0 … 90
};

/// The object's triangles within all bounds. What shows nothing has neither colour nor features.
TriangleSet triangles_like(const PlacedNode& placed, const Likeness& model, const LikenessBounds& bounds);

}  // namespace rebake
