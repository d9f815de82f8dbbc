#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mesh_ops/scene/scene.h"

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
  /// Lies on the surface, and shows where that does; corners differ in opacity.
  struct Triangle {
    std::array<Vec3, 3> corners;
    std::array<double, 3> opacity{1, 1, 1};
  };
  using Triangles = std::shared_ptr<const std::vector<Triangle>>;
  Triangles triangles;  ///< null for none
  Color triangle_color{1, 0.3, 0.1};
  bool selection = true;         ///< tints and outlines selected triangles
  std::vector<NodeId> dimmed;    ///< nodes whose selected triangles are drawn faintly
  std::vector<NodeId> outlined;  ///< nodes with a line around them

  /// Another look at the triangles, in place of their colours; at 1 sample a pixel.
  enum class Inspect {
    none,
    wireframe,     ///< every triangle that may show something, transparent parts too
    opacity,       ///< opaque texels light, transparent ones dark
    texture_sets,  ///< a colour for each
    channel,       ///< one feature byte as grey
    overdraw       ///< brighter where more opaque triangles lie behind each other
  };
  Inspect inspect = Inspect::none;
  int channel = 1;  ///< 0 … 3 of feat0 (0 is opacity), 4 … 7 of feat1

  bool operator==(const Guides&) const = default;
};

}  // namespace rebake
