#include "editor/edits/select/select_unneeded.h"

#include "editor/edits/describe_edit.h"
#include "editor/edits/stored_view.h"

#include <fmt/format.h>

#include "mesh_ops/index/opacity.h"
#include "mesh_ops/select/duplicates.h"

namespace rebake {

namespace {

TriangleSet transparent_triangles(const BakedObject& object) {
  TriangleSet flags;
  for (const TextureSet& set : object.sets)
    for (const std::uint8_t shows : faces_with_opaque_texels(set)) flags.push_back(shows != 0 ? 0 : 1);
  return flags;
}

void add(TriangleSet& flags, const TriangleSet& more) {
  for (std::size_t f = 0; f < flags.size(); ++f) flags[f] |= more[f];
}

}  // namespace

Scene apply(const Scene& scene, const SelectUnneeded& edit) {
  if (!edit.transparent && !edit.duplicates && edit.unseen == 0 && edit.unseen_from.empty())
    throw FieldError("transparent", "at least one of transparent, duplicates, unseen and unseen_from must be given");
  if (edit.unseen < 0 || edit.unseen > 100000) throw FieldError("unseen", "must lie between 0 and 100000");
  if (!(edit.distance > 1)) throw FieldError("distance", "must be above 1, so that the eyes are outside the box");
  std::vector<Camera> cameras;
  for (const std::string& name : edit.unseen_from) cameras.push_back(stored_view(scene, name, "unseen_from"));
  return with_selected(scene, selectable(scene, edit.node), edit.mode, [&](const PlacedNode& placed) {
    const BakedObject& object = *placed.node->object;
    TriangleSet flags(object.triangle_count(), 0);
    if (edit.transparent) add(flags, transparent_triangles(object));
    if (edit.duplicates) add(flags, duplicate_triangles(object));
    if (edit.unseen > 0)
      add(flags, triangles_unseen(object, viewpoints_around(object.bounds(), edit.unseen, edit.distance)));
    std::vector<Viewpoint> eyes;
    for (const Camera& camera : cameras) eyes.push_back(viewpoint_of(camera, placed.to_world.inverse()));
    if (!eyes.empty()) add(flags, triangles_unseen(object, eyes));
    return flags;
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectUnneeded, "Selects triangles that contribute to no picture; check the count, then delete.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("transparent", edit.transparent, Need::optional,
            "without an opaque texel inside or within one texel of the edges");
      visit("duplicates", edit.duplicates, Need::optional, "same vertices and texels as a triangle drawn later");
      visit("unseen", edit.unseen, Need::optional,
            "not visible from this many eyes on a sphere around the object; other objects do not occlude; points in at "
            "least 16 opaque texels per triangle are tested");
      visit("distance", edit.distance, Need::optional, "distance of the eyes, in half diagonals of the object's box");
      visit(
          "unseen_from", edit.unseen_from, Need::optional,
          "names of stored views: not visible from any of their eyes; triangles nearer behind others than 1e-5 of the "
          "object's diagonal count as visible");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
