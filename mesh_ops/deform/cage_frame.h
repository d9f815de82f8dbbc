#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/deform/cage.h"

namespace rebake {

/// A triangle in its own plane. Corner 0 lies opposite the longest edge, which runs from corner 1 to corner 2 along
/// `tangent`; `outward` lies in the plane and points away from corner 0; `normal` = outward of the cage.
template <class R>
struct FaceFrameOf {
  std::array<std::uint32_t, 3> vertices;
  std::array<std::uint32_t, 3> edges{};  ///< opposite each corner
  std::array<R, 3> normal, tangent, outward;
  R length = 0;                         ///< of the longest edge
  R height = 0;                         ///< of corner 0 above it
  R apex = 0;                           ///< of corner 0 along the tangent, from corner 1
  std::array<R, 3> lengths;             ///< of the edges
  std::array<R, 3> edge_t, edge_o;      ///< edge k's unit direction, along tangent and outward
  std::array<R, 3> normal_t, normal_o;  ///< edge k's outward unit normal in the plane, likewise
};
using FaceFrame = FaceFrameOf<double>;

struct EdgeFrame {
  std::uint32_t first, second;
  std::array<double, 3> tangent;  ///< unit, from first to second
  double length;
};

/// A cage in the local frame that coordinates are computed in: moved to its centre and scaled by a power of two to a
/// diagonal between 1 and 2. Frames are computed with 50 digits and then rounded, so that needles have right normals.
struct CageFrame {
  Vec3 center;
  double scale;     ///< local = (x − center) · scale; exact as a factor
  double diagonal;  ///< of the cage's box, in local units
  std::vector<Vec3> vertices;
  std::vector<Vec3> given;       ///< the same, as they came
  std::vector<FaceFrame> faces;  ///< without those that have no area
  std::vector<std::uint32_t> face_numbers;
  std::vector<EdgeFrame> edges;  ///< of those faces

  Vec3 to_local(const Vec3& point) const { return (point - center) * scale; }
  /// Whether a local point lies so far out that faces must be weighed by mean_value_terms' `far_out`: the closed forms
  /// are then off by more than 5e-14. False for what is no number.
  bool is_far_out(const Vec3& local) const { return local.stableNorm() > 2 * diagonal; }
};

/// Throws Error when the cage has no extent: fewer than two different points.
CageFrame frame_of(const Cage& cage);

}  // namespace rebake
