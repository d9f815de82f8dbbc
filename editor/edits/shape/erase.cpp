#include "editor/edits/shape/erase.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"
#include "editor/edits/scene_change.h"

#include "mesh_ops/base/counted.h"
#include "mesh_ops/features/atlas/erase_texels.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

namespace {

Outcome erased(const Scene& scene, const std::vector<PlacedNode>& targets,
               const std::function<ObjectRegion(const PlacedNode&)>& region_in) {
  Scene result = scene;
  std::uint64_t texels = 0;
  for (const PlacedNode& placed : targets) {
    const ObjectRegion region = region_in(placed);
    Erased change = erase_texels(*placed.node->object, region.inside, region.may_touch);
    texels += change.texels;
    if (change.texels == 0) continue;
    result = with_changed(result, placed.node->id,
                          [&](Node& node) { node.object = with_sets(*node.object, std::move(change.sets)); });
  }
  if (texels == 0) throw EditError("the region contains no opaque texel, so nothing was erased");
  SharedTotals left;
  for (const PlacedNode& placed : placed_nodes(result))
    if (placed.node->object) left.add(*placed.node->object);
  return {
      std::move(result),
      {{fmt::format("{} cleared, {} left", counted(texels, "texel"), counted(left.opaque_texels(), "opaque one"))}}};
}

std::vector<PlacedNode> targets_of(const Scene& scene, const Erase& edit) {
  if (edit.nodes.empty()) return selectable(scene, edit.node);
  if (edit.node) throw FieldError("nodes", "cannot be combined with node");
  return objects_of_each(scene, edit.nodes, selectable);
}

}  // namespace

Outcome apply(const Scene& scene, const Erase& edit) {
  const std::vector<PlacedNode> targets = targets_of(scene, edit);
  const bool in_picture = edit.picture.polygon || edit.picture.brush || edit.picture.depth;
  const int ways =
      int{edit.box.has_value()} + int{edit.sphere.has_value()} + int{edit.half_space.has_value()} + int{in_picture};
  if (ways != 1) throw FieldError("box", "exactly one of box, sphere, half_space and a picture region must be given");
  if (in_picture) {
    const PictureRegion region(scene, edit.picture, targets);
    std::vector<PlacedNode> occluders = visible_objects(scene);
    for (const PlacedNode& target : targets)
      if (!target.visible) occluders.push_back(target);
    const std::optional<SceneRays> rays = edit.through ? std::nullopt : std::optional(rays_through(occluders));
    return erased(scene, targets, [&](const PlacedNode& placed) {
      const auto inside = [&region, &rays, to_world = placed.to_world](const Vec3& p) {
        const Vec3 world = to_world * p;
        return region.contains(world) && !(rays && rays->blocked(region.projector().start_for(world), world));
      };
      const auto may_touch = [&region, to_world = placed.to_world](const std::array<Vec3, 3>& corners) {
        return region.may_touch({to_world * corners[0], to_world * corners[1], to_world * corners[2]});
      };
      return ObjectRegion{inside, may_touch};
    });
  }
  return erased(scene, targets, [&](const PlacedNode& placed) {
    const FrameTransform points(edit.frame, placed);
    if (edit.box) return region_of(points, *edit.box);
    if (edit.sphere) return region_of(points, *edit.sphere);
    return region_of(points, *edit.half_space);
  });
}

std::string change_title(const Erase&, const SceneChange& change, const Erase*) {
  return "Erased in " + listed(change.names);
}

REBAKE_DESCRIBE_EDIT(
    Erase, "Makes texels inside a region transparent, to cut through triangles; all other texels stay bit for bit.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("nodes", edit.nodes, Need::optional, "only these nodes and their children, in place of node");
      visit("box", edit.box, Need::optional, "inside a box");
      visit("sphere", edit.sphere, Need::optional, "inside a sphere; radius as for select");
      visit("half_space", edit.half_space, Need::optional, "in the half-space that the normal points into");
      visit("frame", edit.frame, Need::optional, "coordinates of box, sphere and half_space, as for select");
      PictureFields::fields(edit.picture, visit);
      visit("through", edit.through, Need::optional, "in a picture: also occluded texels");
    })

}  // namespace rebake
