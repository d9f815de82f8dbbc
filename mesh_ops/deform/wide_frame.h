#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mesh_ops/deform/cage_frame.h"

namespace rebake {

/// 113 bits, for the few terms that cancel beyond what double holds.
using Quad = boost::multiprecision::cpp_bin_float_quad;

/// A point of the cage's space in the cage's frame.
std::array<Quad, 3> wide_place(const CageFrame& cage, const Vec3& point);

/// A face of the cage in the cage's frame.
struct WideFace {
  FaceFrameOf<Quad> frame;
  std::array<std::array<Quad, 3>, 3> corners;
};
WideFace wide_face(const CageFrame& cage, const FaceFrame& face);

}  // namespace rebake
