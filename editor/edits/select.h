#pragma once

#include "editor/edits/regions.h"
#include "editor/edits/support.h"

namespace rebake {

struct Select {
  static constexpr const char* op = "select";
  static constexpr const char* help = "Selects triangles of a node by their centres.";
  NodeRef node;
  bool all = false;
  bool none = false;
  bool invert = false;
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  std::optional<Vec3> connected;
  SelectMode mode = SelectMode::set;
  CoordinateFrame frame = CoordinateFrame::world;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node whose triangles are selected");
    visit("all", self.all, Need::optional, "every triangle");
    visit("none", self.none, Need::optional, "no triangle");
    visit("invert", self.invert, Need::optional, "those not selected now");
    visit("box", self.box, Need::optional, "inside a box");
    visit("sphere", self.sphere, Need::optional,
          "inside a sphere; radius in units of the frame, in frame bounds as a share of the box diagonal");
    visit("half_space", self.half_space, Need::optional, "on the side that the normal points to");
    visit("connected", self.connected, Need::optional,
          "joined through shared corners to the triangle nearest to this point");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
    visit("frame", self.frame, Need::optional,
          "world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1");
  }
};

inline Scene apply(const Scene& scene, const Select& edit) {
  const PlacedNode placed = editable(scene, edit.node.id);
  if (!placed.node->object)
    throw EditError("node \"" + placed.node->name + "\" is a group; select triangles of its objects");
  const int ways = int{edit.all} + int{edit.none} + int{edit.invert} + int{edit.box.has_value()} +
                   int{edit.sphere.has_value()} + int{edit.half_space.has_value()} + int{edit.connected.has_value()};
  if (ways != 1)
    throw FieldError("box", "exactly one of all, none, invert, box, sphere, half_space and connected must be given");
  const BakedObject& object = *placed.node->object;
  TriangleSet flags(object.triangle_count(), 0);
  if (placed.node->selection) flags = *placed.node->selection;
  if (edit.invert) {
    for (auto& flag : flags) flag = flag == 0 ? 1 : 0;
  } else {
    const FramePoints points(edit.frame, placed);
    TriangleSet found(flags.size(), edit.all ? 1 : 0);
    if (edit.box) found = triangles_inside(object, points, *edit.box);
    if (edit.sphere) found = triangles_inside(object, points, *edit.sphere);
    if (edit.half_space) found = triangles_inside(object, points, *edit.half_space);
    if (edit.connected) found = triangles_connected(object, points.to_object(*edit.connected));
    for (std::size_t f = 0; f < flags.size(); ++f) {
      switch (edit.mode) {
        case SelectMode::set:
          flags[f] = found[f];
          break;
        case SelectMode::add:
          flags[f] = flags[f] | found[f];
          break;
        case SelectMode::remove:
          flags[f] = found[f] != 0 ? 0 : flags[f];
          break;
        case SelectMode::intersect:
          flags[f] = flags[f] & found[f];
          break;
      }
    }
  }
  return with_changed(scene, edit.node.id, [&](Node& node) {
    node.selection = count(flags) == 0 ? nullptr : std::make_shared<const TriangleSet>(std::move(flags));
  });
}

}  // namespace rebake
