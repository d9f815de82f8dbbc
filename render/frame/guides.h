#pragma once

#include <vector>

#include "mesh_ops/scene/types.h"

namespace rebake {

/// What an editor draws over the picture, in world space.
struct Guides {
  struct Line {
    Vec3 from, to;
    Color color{1, 1, 1};  ///< display colour, 0 … 1
    double opacity = 1;
    double hidden_opacity = 1;  ///< where something lies in front
    bool operator==(const Line&) const = default;
  };
  std::vector<Line> lines;
  bool selection = true;  ///< tints and outlines selected triangles

  bool operator==(const Guides&) const = default;
};

}  // namespace rebake
