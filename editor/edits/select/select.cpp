#include "editor/edits/select/select.h"

#include "editor/edits/describe_edit.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/morphology.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

namespace {

// Flags of the triangles of one texture set; no flag is set if the object has fewer sets.
TriangleSet triangles_of_set(const BakedObject& object, std::size_t wanted) {
  TriangleSet flags;
  for (std::size_t i = 0; i < object.sets.size(); ++i)
    flags.insert(flags.end(), object.sets[i].soup.triangle_count(), i == wanted ? 1 : 0);
  return flags;
}

void check_texture_set(const std::vector<PlacedNode>& targets, int wanted) {
  std::size_t most = 0;
  for (const PlacedNode& placed : targets) most = std::max(most, placed.node->object->sets.size());
  if (wanted < 0 || static_cast<std::size_t>(wanted) >= most)
    throw FieldError("texture_set", targets.size() == 1
                                        ? fmt::format("is out of range: \"{}\" has {}, counted from 0",
                                                      targets.front().node->name, counted(most, "texture set"))
                                        : fmt::format("is out of range: no object has more than {}, counted from 0",
                                                      counted(most, "texture set")));
}

}  // namespace

Scene apply(const Scene& scene, const Select& edit) {
  const int ways = int{edit.all} + int{edit.none} + int{edit.invert} + int{edit.box.has_value()} +
                   int{edit.sphere.has_value()} + int{edit.half_space.has_value()} + int{edit.connected.has_value()} +
                   int{edit.texture_set.has_value()} + int{!edit.saved.empty()};
  if (ways != 1)
    throw FieldError("box",
                     "exactly one of all, none, invert, box, sphere, half_space, connected, texture_set and saved must "
                     "be given");
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  if (!edit.saved.empty() && std::none_of(targets.begin(), targets.end(), [&](const PlacedNode& placed) {
        return placed.node->saved_selections.contains(edit.saved);
      }))
    throw FieldError("saved", fmt::format("there is no stored selection \"{}\"", edit.saved));
  // `connected` starts at one triangle of one target.
  std::optional<NearestTriangle> start;
  if (edit.connected) {
    Vec3 point = *edit.connected;
    if (edit.frame != CoordinateFrame::world) {
      if (targets.size() != 1) throw FieldError("frame", "must be world if the selection covers several objects");
      point = targets[0].to_world * FrameTransform(edit.frame, targets[0]).to_object(point);
    }
    start = nearest_triangle(targets, point, false);
  }
  if (edit.texture_set) check_texture_set(targets, *edit.texture_set);
  std::size_t index = 0;
  return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
    const std::size_t k = index++;
    const BakedObject& object = *placed.node->object;
    const FrameTransform points(edit.frame, placed);
    if (edit.invert) {
      TriangleSet flags = selection_of(placed);
      for (auto& flag : flags) flag = flag != 0 ? 0 : 1;
      return flags;
    }
    if (edit.box) return triangles_by_centre(object, region_of(points, *edit.box).inside);
    if (edit.sphere) return triangles_by_centre(object, region_of(points, *edit.sphere).inside);
    if (edit.half_space) return triangles_by_centre(object, region_of(points, *edit.half_space).inside);
    if (start && start->target == k && object.triangle_count() > 0)
      return connected_to(*corners_of(object), start->triangle);
    if (edit.texture_set) return triangles_of_set(object, static_cast<std::size_t>(*edit.texture_set));
    if (const auto saved = placed.node->saved_selections.find(edit.saved);
        !edit.saved.empty() && saved != placed.node->saved_selections.end())
      return *saved->second;
    return TriangleSet(object.triangle_count(), edit.all ? 1 : 0);
  });
}

REBAKE_DESCRIBE_EDIT(
    Select, "Selects triangles by region (of their centres), connectivity, texture set or stored selection.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("all", edit.all, Need::optional, "every triangle");
      visit("none", edit.none, Need::optional, "no triangle");
      visit("invert", edit.invert, Need::optional, "unselected triangles");
      visit("box", edit.box, Need::optional, "inside a box");
      visit("sphere", edit.sphere, Need::optional,
            "inside a sphere; radius in units of the frame (bounds: relative to the box diagonal)");
      visit("half_space", edit.half_space, Need::optional, "in the half-space that the normal points into");
      visit("connected", edit.connected, Need::optional,
            "triangles connected, through shared vertices, to the triangle nearest to this point");
      visit("texture_set", edit.texture_set, Need::optional, "triangles of this texture set, counted from 0");
      visit("saved", edit.saved, Need::optional, "selection stored by store_selection under this name");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
      visit("frame", edit.frame, Need::optional,
            "coordinates: world; node: object space; bounds: relative to the object's box, 0 to 1");
    })

}  // namespace rebake
