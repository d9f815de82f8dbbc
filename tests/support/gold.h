#pragma once

#include <boost/multiprecision/mpfr.hpp>
#include <vector>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake::test {

/// A number with 120 decimal digits, the reference precision for cage coordinates.
using Gold =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<120>, boost::multiprecision::et_off>;
using Gold3 = std::array<Gold, 3>;

Gold3 gold(const Vec3& v);

/// Mean value weights by the textbook's vectors (Ju, Schaefer, Warren 2005), normalised; one per cage vertex.
std::vector<Gold> gold_mean_value(const Cage& cage, const Gold3& point);

/// Green's coordinates by the textbook's solid angle and logarithms (Urago 2000; Lipman et al. 2008): one φ per vertex,
/// then one ψ per face. The point must be inside.
std::vector<Gold> gold_green(const Cage& cage, const Gold3& point);

/// Gradient of each weight at a point, by central differences with a step of 1e-40.
std::vector<Vec3> gold_gradients(std::vector<Gold> (*weights)(const Cage&, const Gold3&), const Cage& cage,
                                 const Vec3& point);

}  // namespace rebake::test
