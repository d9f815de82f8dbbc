#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mesh_ops/deform/cage_frame.h"

namespace rebake {

/// 50 decimal digits, for the few terms that cancel beyond what double holds.
using Wide = boost::multiprecision::cpp_bin_float_50;

/// A point of the cage's space in the cage's frame.
std::array<Wide, 3> wide_place(const CageFrame& cage, const Vec3& point);

/// A face of the cage in the cage's frame.
struct WideFace {
  FaceFrameOf<Wide> frame;
  std::array<std::array<Wide, 3>, 3> corners;
};
WideFace wide_face(const CageFrame& cage, const FaceFrame& face);

}  // namespace rebake
