#include "editor/edits/nodes/place.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

Placement placement_of(const Affine& to_parent) {
  Placement result;
  result.position = to_parent.translation();
  Mat3 turn = orthogonal_factor(to_parent.linear());
  // A mirrored transform is a reflection along x followed by a rotation.
  if (turn.determinant() < 0) turn.col(0) = -turn.col(0);
  const Mat3 stretch = turn.transpose() * to_parent.linear();
  result.rotation = turn;
  result.scale = stretch.diagonal();
  const double size = stretch.cwiseAbs().maxCoeff();
  constexpr double rounding = 1e-12;  // relative rounding error of matrix products
  const Mat3 rest = stretch - Mat3(stretch.diagonal().asDiagonal());
  result.sheared = rest.cwiseAbs().maxCoeff() > rounding * size;
  if (result.sheared) result.shear = stretch * result.scale.cwiseInverse().asDiagonal();
  return result;
}

Scene apply(const Scene& scene, const Place& edit) {
  if (!edit.position && !edit.rotation && !edit.scale)
    throw FieldError("position", "at least one of position, rotation and scale must be given");
  const PlacedNode placed = editable_with_children(scene, edit.node.id);
  Affine to_parent = placed.node->to_parent;
  if (edit.rotation || edit.scale) {
    check_invertible(to_parent);
    const Placement now = placement_of(to_parent);
    const Mat3 rotation = edit.rotation ? edit.rotation->matrix() : now.rotation;
    const Vec3 scale = edit.scale ? edit.scale->value : now.scale;
    // A new scale along the node's own axes removes the shear.
    const Mat3 shear = edit.scale ? Mat3(Mat3::Identity()) : now.shear;
    to_parent.linear() = rotation * shear * scale.asDiagonal();
  }
  if (edit.position) to_parent.translation() = *edit.position;
  if (!to_parent.matrix().allFinite()) throw EditError("the resulting transform is not finite");
  const Scene result = with_changed(scene, edit.node.id, [&](Node& node) { node.to_parent = to_parent; });
  check_subtree(result, edit.node.id);
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Place, "Sets a node's position, rotation and scale relative to its parent.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to place");
      visit("position", edit.position, Need::optional, "position of its origin; default: unchanged", Unit::length);
      visit("rotation", edit.rotation, Need::optional, "rotation relative to its parent; default: unchanged");
      visit("scale", edit.scale, Need::optional,
            "factors along its own axes; negative values mirror, 0 is refused; default: unchanged");
    })

}  // namespace rebake
