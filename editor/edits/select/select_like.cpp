#include "editor/edits/select/select_like.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/morphology.h"
#include "mesh_ops/select/triangle_appearance.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectLike& edit) {
  if (!edit.color && !edit.features && !edit.opacity && !edit.size && !edit.orientation)
    throw FieldError("color", "at least one of color, features, opacity, size and orientation must be given");
  const auto not_negative = [](const char* name, const std::optional<double>& value) {
    if (value && *value < 0) throw FieldError(name, "must not be negative");
  };
  not_negative("color", edit.color);
  not_negative("features", edit.features);
  not_negative("opacity", edit.opacity);
  not_negative("orientation", edit.orientation);
  if (edit.size && *edit.size < 1) throw FieldError("size", "must be at least 1");
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  std::vector<TriangleSet> picked;
  if (edit.point) {
    const NearestTriangle nearest = nearest_triangle(targets, *edit.point, true);
    for (const PlacedNode& placed : targets) picked.emplace_back(placed.node->object->triangle_count(), 0);
    picked[nearest.target].at(nearest.triangle) = 1;
  } else {
    objects_with_selection(scene, edit.node);
    for (const PlacedNode& placed : targets) picked.push_back(selection_of(placed));
  }
  const TriangleAppearance model = mean_appearance(targets, picked);
  if (edit.orientation && !(model.area > 0))
    throw FieldError("orientation", "the reference triangles have no area, so no orientation");
  std::size_t k = 0;
  return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
    const TriangleSet& from = picked[k++];
    TriangleSet alike =
        triangles_like(placed, model, {edit.color, edit.features, edit.opacity, edit.size, edit.orientation});
    return edit.contiguous ? connected_within(*corners_of(*placed.node->object), alike, from) : alike;
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectLike,
    "Selects triangles that are similar to a reference within all given tolerances: to the mean of the "
    "present selection, or to the triangle nearest to a point.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("point", edit.point, Need::optional,
            "world point near an opaque triangle; default: the present selection is the reference");
      visit("color", edit.color, Need::optional, "distance of mean decoded colours, channels 0 to 1");
      visit("features", edit.features, Need::optional, "root mean square difference of mean features", Unit::share);
      visit("opacity", edit.opacity, Need::optional, "difference of the share of opaque texels", Unit::share);
      visit("size", edit.size, Need::optional, "between world areas, at least 1", Unit::factor);
      visit("orientation", edit.orientation, Need::optional, "between planes in world space, 0 to 90", Unit::degrees);
      visit("contiguous", edit.contiguous, Need::optional,
            "only triangles connected to the reference through shared vertices");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
