#pragma once

#include "editor/edits/selecting.h"

namespace rebake {

struct Select {
  static constexpr const char* op = "select";
  static constexpr const char* help = "Selects triangles by their centres.";
  std::optional<NodeRef> node;
  bool all = false;
  bool none = false;
  bool invert = false;
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  std::optional<Vec3> connected;
  std::optional<int> texture_set;
  std::string saved;
  SelectMode mode = SelectMode::set;
  CoordinateFrame frame = CoordinateFrame::world;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("all", self.all, Need::optional, "every triangle");
    visit("none", self.none, Need::optional, "no triangle");
    visit("invert", self.invert, Need::optional, "those not selected now");
    visit("box", self.box, Need::optional, "inside a box");
    visit("sphere", self.sphere, Need::optional,
          "inside a sphere; radius in units of the frame, in frame bounds as a share of the box diagonal");
    visit("half_space", self.half_space, Need::optional, "on the side that the normal points to");
    visit("connected", self.connected, Need::optional,
          "joined through shared corners to the triangle nearest to this point");
    visit("texture_set", self.texture_set, Need::optional, "of this texture set, counted from 0");
    visit("saved", self.saved, Need::optional, "stored by store_selection under this name");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
    visit("frame", self.frame, Need::optional,
          "world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1");
  }
};

Scene apply(const Scene& scene, const Select& edit);

}  // namespace rebake
