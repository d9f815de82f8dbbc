#include "editor/edits/nodes/transform.h"

#include <algorithm>

#include "editor/edits/describe_edit.h"
#include "editor/edits/scene_change.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

// The matrix of the scale along its axes.
Mat3 scaling(const Transform& edit) {
  // Without rotated axes, or with a uniform scale, the matrix is exact.
  const Vec3& scale = edit.scale.value;
  if (edit.scale_axes.quaternion().vec().isZero(0) || (scale.array() == scale[0]).all()) return scale.asDiagonal();
  const Mat3 axes = edit.scale_axes.matrix();
  const Mat3 product = axes * scale.asDiagonal() * axes.transpose();
  return (product + product.transpose()) / 2;
}

Scene apply(const Scene& scene, const Transform& edit) {
  const PlacedNode placed = editable_with_children(scene, edit.node.id);
  if (edit.selection) object_with_selection(scene, edit.node);
  Affine motion = Affine::Identity();
  const Mat3 linear = edit.rotate.matrix() * scaling(edit);
  Vec3 pivot = edit.pivot.value_or(placed.to_world.translation());
  if (!edit.pivot && !linear.isIdentity(0)) {
    const Box box = edit.selection ? selection_bounds(placed) : triangle_bounds(scene, edit.node.id);
    if (!box.isEmpty()) pivot = box.center();
  }
  motion.linear() = linear;
  // A pure translation is exact, without rounding errors from the pivot.
  motion.translation() = linear.isIdentity(0) ? edit.translate : Vec3(pivot + edit.translate - linear * pivot);
  if (!motion.matrix().allFinite()) throw EditError("the transform is not finite");
  if (!edit.selection) return moved_in_world(scene, edit.node.id, motion);
  const Affine in_object = placed.to_world.inverse() * motion * placed.to_world;
  check_invertible(in_object);
  // The decoder's view directions are rotated back by the orthogonal factor of the whole transform, in object space.
  const Mat3 turn = orthogonal_factor(placed.to_world.linear()).transpose() *
                    orthogonal_factor(motion.linear() * placed.to_world.linear());
  const Scene result = with_changed(scene, edit.node.id, [&](Node& node) {
    std::vector<TextureSet> sets;
    std::size_t first = 0;
    for (const TextureSet& set : node.object->sets) {
      const auto begin = node.selection->begin() + static_cast<std::ptrdiff_t>(first);
      const bool any = std::any_of(begin, begin + static_cast<std::ptrdiff_t>(set.soup.triangle_count()),
                                   [](auto flag) { return flag != 0; });
      sets.push_back(any ? TextureSet{move_faces(set.soup, *node.selection, first, in_object, turn), set.texels} : set);
      first += set.soup.triangle_count();
    }
    node.object = with_sets(*node.object, std::move(sets));
  });
  check_subtree(result, edit.node.id);
  return result;
}

std::string done_words(const Transform& edit) {
  const bool turns = !edit.rotate.matrix().isIdentity(0), scales = edit.scale.value != Vec3::Ones();
  return turns && !scales ? "Rotated" : scales && !turns ? "Scaled" : scales ? "Rotated and scaled" : "Moved";
}

std::string change_title(const Transform& edit, const SceneChange& change, const Transform*) {
  if (!edit.selection) return "";
  if (change.moved == 0) return done_words(edit) + " 0 triangles";
  return done_words(edit) + " " + triangles_text(change.moved) + " of " + listed(change.with_moved);
}

REBAKE_DESCRIBE_EDIT(
    Transform, "Scales, rotates and translates, in this order, a node or its selected triangles about a pivot.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to transform");
      visit("selection", edit.selection, Need::optional, "only the selected triangles");
      visit("translate", edit.translate, Need::optional, "translation", Unit::length);
      visit("rotate", edit.rotate, Need::optional, "rotation");
      visit("scale", edit.scale, Need::optional, "scale factors; negative values mirror, 0 is refused");
      visit("scale_axes", edit.scale_axes, Need::optional, "rotation from the world axes to the axes of the scale");
      visit("pivot", edit.pivot, Need::optional,
            "fixed world point of rotation and scale; default: centre of the bounding box");
    })

}  // namespace rebake
