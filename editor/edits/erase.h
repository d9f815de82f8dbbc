#pragma once

#include "editor/edits/selecting.h"

namespace rebake {

struct Erase {
  static constexpr const char* op = "erase";
  static constexpr const char* help =
      "Clears the opacity of texels inside a region or in a picture, where an object's edge runs through triangles; "
      "all "
      "other texels stay bit for bit.";
  std::optional<NodeRef> node;
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  CoordinateFrame frame = CoordinateFrame::world;
  PictureFields picture;
  bool through = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("box", self.box, Need::optional, "inside a box");
    visit("sphere", self.sphere, Need::optional, "inside a sphere; radius as for select");
    visit("half_space", self.half_space, Need::optional, "on the side that the normal points to");
    visit("frame", self.frame, Need::optional, "of box, sphere and half_space, as for select");
    PictureFields::fields(self.picture, visit);
    visit("through", self.through, Need::optional, "in a picture: hidden texels too");
  }
};

Scene apply(const Scene& scene, const Erase& edit);

}  // namespace rebake
