#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// A triangle in its own plane. Corner 0 lies opposite the longest edge, which runs from corner 1 to corner 2 along
/// `tangent`. `outward` lies in the plane and points away from corner 0. `normal` points out of the cage. Edge k lies
/// opposite corner k.
template <class R>
struct FaceFrameOf {
  std::array<std::uint32_t, 3> vertices;
  std::array<std::uint32_t, 3> edges{};  ///< numbers in CageFrame::edges; edge k lies opposite corner k
  std::array<R, 3> normal, tangent, outward;
  R length = 0;                     ///< length of the longest edge
  R height = 0;                     ///< distance of corner 0 from the longest edge
  R apex = 0;                       ///< position of corner 0 along the tangent, measured from corner 1
  std::array<R, 3> lengths;         ///< lengths of the edges
  std::array<R, 3> edge_t, edge_o;  ///< unit direction of edge k: components along tangent and outward
  /// Outward unit normal of edge k in the plane: components along tangent and outward.
  std::array<R, 3> normal_t, normal_o;
};
using FaceFrame = FaceFrameOf<double>;

/// An edge of a cage in the local frame of CageFrame.
struct EdgeFrame {
  std::uint32_t first, second;
  std::array<double, 3> tangent;  ///< unit vector from first to second
  double length;                  ///< local units
};

/// A cage in the local frame in which coordinates are computed: centred, and scaled by a power of two to a diagonal
/// between 1 and 2. Face frames are computed with 50 digits and then rounded, so that needles have accurate normals.
struct CageFrame {
  Vec3 center;
  double scale;     ///< local = (x − center) · scale; a power of two, so the product is exact
  double diagonal;  ///< diagonal of the cage's box, in local units
  /// How far points on the surface may lie outside by rounding, in local units: more for cages far from the origin.
  double surface_tolerance;
  std::vector<Vec3> vertices;               ///< in the local frame
  std::vector<Vec3> given;                  ///< vertices in the space of the cage, unchanged
  std::vector<FaceFrame> faces;             ///< faces with an area; faces without one are left out
  std::vector<std::uint32_t> face_numbers;  ///< number in the cage, per entry of `faces`
  std::vector<EdgeFrame> edges;             ///< edges of `faces`

  Vec3 to_local(const Vec3& point) const { return (point - center) * scale; }
  /// Whether a local point is so far from the cage that faces must be evaluated with the `far_out` flag of
  /// mean_value_terms(): closed forms are then off by more than 5e-14. False for NaN.
  bool is_far_out(const Vec3& local) const { return local.stableNorm() > 2 * diagonal; }
};

/// Throws Error if the cage has no extent (fewer than two different points) or is too small to scale.
CageFrame frame_of(const Cage& cage);

}  // namespace rebake
