#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A point that stands for some surface.
struct WeightedPoint {
  Vec3 at;
  double weight = 1;  ///< e.g. its area
};

/// The line along which a part is bent.
struct Spine {
  Vec3 foot{0, 0, 0};   ///< where the part hangs on the rest
  Vec3 along{0, 1, 0};  ///< of length 1, away from there
  double length = 0;    ///< to the part's far end
  double width = 0;     ///< of the part near its foot: twice the mean distance from the line
  /// Over which share of the length the rest touches the part: near 0 for a branch that hangs at its stem, near 1 where
  /// some of the part was not taken.
  double touched = 0;
  /// Through the middle of the part, from its foot to its far end; for a straight part the line itself. Two points or
  /// more.
  std::vector<Vec3> curve;
};

/// The spine of `part`: the direction in which it is longest, or where it has none, that from where it touches `rest`
/// to its middle. Its foot is at the end where `rest` is nearer; without a rest that touches, at the lower end. Nothing
/// for parts without extent. Takes time in proportion to the number of points.
std::optional<Spine> spine_of(const std::vector<WeightedPoint>& part, const std::vector<WeightedPoint>& rest);

}  // namespace rebake
