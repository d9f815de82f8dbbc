#pragma once

#include "editor/edits/selecting.h"
#include "mesh_ops/select/index.h"

namespace rebake {

struct SelectLike {
  static constexpr const char* op = "select_like";
  static constexpr const char* help =
      "Selects triangles that are like the picked ones: within every tolerance that is given, of the mean over the "
      "present selection or of the triangle nearest to a point.";
  std::optional<NodeRef> node;
  std::optional<Vec3> point;
  std::optional<double> color, features, opacity, size, orientation;
  SelectMode mode = SelectMode::set;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("point", self.point, Need::optional,
          "world point, near a triangle that shows something; left out: like the present selection");
    visit("color", self.color, Need::optional, "distance of mean decoded colours, channels 0 to 1");
    visit("features", self.features, Need::optional, "root mean square difference of mean features, 0 to 1");
    visit("opacity", self.opacity, Need::optional, "difference of the share of opaque texels, 0 to 1");
    visit("size", self.size, Need::optional, "factor between areas in the world, at least 1");
    visit("orientation", self.orientation, Need::optional, "degrees between planes in the world, 0 to 90");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
  }
};

Scene apply(const Scene& scene, const SelectLike& edit);

}  // namespace rebake
