#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mesh_ops/deform/cage_coordinates/cage_frame.h"

namespace rebake {

/// Number with 50 decimal digits, for the few terms that lose all digits to cancellation in double.
using Wide = boost::multiprecision::cpp_bin_float_50;

inline std::array<Wide, 3> minus(const std::array<Wide, 3>& a, const std::array<Wide, 3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Wide dot(const std::array<Wide, 3>& a, const std::array<Wide, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline std::array<Wide, 3> cross(const std::array<Wide, 3>& a, const std::array<Wide, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Local coordinates (CageFrame) of a point in the space of the cage.
std::array<Wide, 3> wide_local_point(const CageFrame& cage, const Vec3& point);

/// A face in local coordinates: its frame and corner positions.
struct WideFace {
  FaceFrameOf<Wide> frame;
  std::array<std::array<Wide, 3>, 3> corners;
};
WideFace wide_face(const CageFrame& cage, const FaceFrame& face);

}  // namespace rebake
