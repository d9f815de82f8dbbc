#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Overlays that an editor draws over the picture. Positions are in world space.
struct Guides {
  struct Line {
    Vec3 from, to;
    Color color{1, 1, 1};  ///< display colour, 0 … 1
    double opacity = 1;
    double hidden_opacity = 1;  ///< opacity of parts that are occluded
    bool operator==(const Line&) const = default;
  };
  std::vector<Line> lines;
  /// A triangle on a visible surface, drawn where that surface is visible; opacity is interpolated between corners.
  struct Triangle {
    std::array<Vec3, 3> corners;
    std::array<double, 3> opacity{1, 1, 1};
  };
  using Triangles = std::shared_ptr<const std::vector<Triangle>>;
  Triangles triangles;  ///< null for none
  Color triangle_color{1, 0.3, 0.1};
  bool selection = true;         ///< whether selected triangles are tinted and outlined
  std::vector<NodeId> dimmed;    ///< nodes whose selected triangles have a faint tint
  std::vector<NodeId> outlined;  ///< nodes drawn with an outline

  /// Debug view drawn in place of colours, at 1 sample per pixel.
  enum class Inspect {
    none,
    wireframe,     ///< edges of triangles that may have opaque texels, transparent parts too
    opacity,       ///< opaque texels are light, transparent ones dark
    texture_sets,  ///< one colour per texture set
    channel,       ///< the feature byte `channel` as grey
    overdraw       ///< brighter with more layers of opaque texels
  };
  Inspect inspect = Inspect::none;
  int channel = 1;  ///< for Inspect::channel: 0 … 3 for RGBA of feat0 (0 is opacity), 4 … 7 of feat1

  bool operator==(const Guides&) const = default;
};

}  // namespace rebake
