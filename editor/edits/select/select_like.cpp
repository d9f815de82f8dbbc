#include "editor/edits/select/select_like.h"

#include "editor/edits/describe.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/likeness.h"
#include "mesh_ops/select/morphology.h"

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
  if (edit.size && *edit.size < 1) throw FieldError("size", "is a factor of at least 1");
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  std::vector<TriangleSet> picked;
  if (edit.point) {
    const NearestTriangle nearest = nearest_triangle(targets, *edit.point, true);
    for (const PlacedNode& placed : targets) picked.emplace_back(placed.node->object->triangle_count(), 0);
    picked[nearest.target].at(nearest.triangle) = 1;
  } else {
    with_selection(scene, edit.node);
    for (const PlacedNode& placed : targets) picked.push_back(selection_of(placed));
  }
  const Likeness model = mean_likeness(targets, picked);
  if (edit.orientation && !(model.area > 0))
    throw FieldError("orientation", "the triangles compared with have no area, so no plane");
  std::size_t k = 0;
  return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
    const TriangleSet& from = picked[k++];
    TriangleSet alike =
        triangles_like(placed, model, {edit.color, edit.features, edit.opacity, edit.size, edit.orientation});
    return edit.contiguous ? joined_within(*corners_of(*placed.node->object), alike, from) : alike;
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectLike,
    "Selects triangles that are like the picked ones: within every tolerance that is given, of the mean over the "
    "present selection or of the triangle nearest to a point.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible and not locked");
      visit("point", edit.point, Need::optional,
            "world point, near a triangle that shows something; left out: like the present selection");
      visit("color", edit.color, Need::optional, "distance of mean decoded colours, channels 0 to 1");
      visit("features", edit.features, Need::optional, "root mean square difference of mean features", Unit::share);
      visit("opacity", edit.opacity, Need::optional, "difference of the share of opaque texels", Unit::share);
      visit("size", edit.size, Need::optional, "between areas in the world, at least 1", Unit::factor);
      visit("orientation", edit.orientation, Need::optional, "between planes in the world, 0 to 90", Unit::degrees);
      visit("contiguous", edit.contiguous, Need::optional,
            "only those that hang together with what they are compared with, through corners they share");
      visit("mode", edit.mode, Need::optional, "how the result joins the present selection");
    })

}  // namespace rebake
