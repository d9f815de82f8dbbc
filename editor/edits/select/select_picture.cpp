#include "editor/edits/select/select_picture.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectPicture& edit) {
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  const PictureRegion region(scene, edit.picture, targets);
  if (edit.through)
    return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
      return projected_triangles(*placed.node->object, placed.to_world, region.projector(), region.mask(),
                                 region.nearest(), region.farthest());
    });
  const std::vector<PlacedNode> objects = visible_objects(scene);
  const std::vector<TriangleSet> seen =
      visible_triangles(objects, region.projector(), region.mask(), region.nearest(), region.farthest());
  return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
    for (std::size_t k = 0; k < objects.size(); ++k)
      if (objects[k].node->id == placed.node->id) return seen[k];
    throw EditError("node \"" + placed.node->name +
                    "\" is hidden, so none of its triangles is visible; show it, or set through");
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectPicture,
    "Selects triangles in a camera's picture: those visible in a pixel of the region, or with through all whose "
    "centre projects into it.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      PictureFields::fields(edit.picture, visit);
      visit("through", edit.through, Need::optional, "also occluded triangles");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
