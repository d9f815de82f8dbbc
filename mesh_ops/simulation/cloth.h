#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Point masses and distance constraints by extended position-based dynamics with small steps (Macklin, Müller and
/// Chentanez 2016; Macklin et al. 2019). Backward Euler in effect: stable at any stiffness and step, and dissipative.
/// Linear momentum is conserved to rounding. Masses in kilograms, lengths in metres, times in seconds.
class Cloth {
 public:
  /// A spring between two points, with the length at which it rests.
  struct Spring {
    std::array<std::uint32_t, 2> points;
    double rest = 0;        ///< metres
    double compliance = 0;  ///< inverse stiffness, metres per newton; 0: rigid
  };

  Cloth(std::vector<Vec3> positions, std::vector<double> masses, std::vector<Spring> springs);

  std::vector<Vec3> positions, velocities;  ///< metres, metres per second
  std::vector<double> masses;               ///< kilograms; 0: held at its position, which the caller may move
  std::vector<Spring> springs;
  Vec3 gravity{0, -9.81, 0};  ///< metres per square second
  double drag = 0;            ///< rate at which velocities relative to the wind decay, per second
  /// Velocity of the air at a place and time, metres per second; empty: still air.
  std::function<Vec3(const Vec3& place, double time)> wind;

  /// Advances by `seconds` in `substeps` equal steps. Held points move evenly from `positions` to `held` (in the order
  /// of the points with mass 0), if given.
  void advance(double seconds, int substeps, const std::vector<Vec3>* held = nullptr);

  double time() const { return time_; }
  /// Kinetic and potential energy in joules: of gravity, relative to the origin, and of springs with compliance.
  double energy() const;
  Vec3 momentum() const;          ///< kilogram metres per second
  Vec3 angular_momentum() const;  ///< about the origin
  /// Largest relative change of length over all springs.
  double largest_stretch() const;

 private:
  void step(double seconds);
  double time_ = 0;
};

/// A square sheet in the plane z = 0, `side`² points in row-major order from the upper left, with springs along its
/// rows, columns and diagonals, and across every second point against bending.
struct SheetOptions {
  int side = 41;             ///< points per side
  double width = 1;          ///< metres
  double mass = 0.2;         ///< kilograms, of the whole sheet
  double stretching = 1e-5;  ///< compliance along rows and columns, metres per newton
  double shearing = 1e-4;    ///< of the diagonals
  double bending = 1e-2;     ///< across every second point
};
Cloth hanging_sheet(const SheetOptions& options);

}  // namespace rebake
