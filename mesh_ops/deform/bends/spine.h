#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A sample point of a surface.
struct WeightedPoint {
  Vec3 at;
  double weight = 1;  ///< relative weight, such as its area
};

/// The line along which a part of an object is bent.
struct Spine {
  Vec3 foot{0, 0, 0};   ///< end of the line at which the part is attached to the rest
  Vec3 along{0, 1, 0};  ///< unit vector from the foot to the far end
  double length = 0;    ///< distance from the foot to the part's far end
  double width = 0;     ///< width of the part near its foot: twice the mean distance from the line
  /// Share of the length over which the rest touches the part, 0 … 1: near 0 for a branch attached at its base, near 1
  /// if only a piece of an object was selected.
  double touched = 0;
  /// Centre line of the part from foot to far end, two points or more; a straight line for straight parts.
  std::vector<Vec3> curve;
};

/// The spine of `part`, along its direction of largest variance. A round part uses the direction from its contact with
/// `rest` to its centre. The foot is at the end nearer to the contact, or at the lower end (−y) if nothing touches.
/// Empty for parts without extent. Time is linear in the number of points.
std::optional<Spine> spine_of(const std::vector<WeightedPoint>& part, const std::vector<WeightedPoint>& rest);

}  // namespace rebake
