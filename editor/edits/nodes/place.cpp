#include "editor/edits/nodes/place.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

// The rotation of a mirrored transform, after the reflection along x, y, z or all three that leaves the smallest one.
Mat3 proper_rotation(const Mat3& orthogonal) {
  if (orthogonal.determinant() > 0) return orthogonal;
  Mat3 least = -orthogonal;
  for (const int axis : {2, 1, 0}) {
    Mat3 turn = orthogonal;
    turn.col(axis) = -turn.col(axis);
    constexpr double rounding = 1e-12;
    if (turn.trace() > least.trace() - rounding) least = turn;
  }
  return least;
}

}  // namespace

Placement placement_of(const Affine& to_parent) {
  Placement result;
  result.position = to_parent.translation();
  const Mat3 turn = proper_rotation(orthogonal_factor(to_parent.linear()));
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

Outcome apply(const Scene& scene, const Place& edit) {
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
  Scene result = with_changed(scene, edit.node.id, [&](Node& node) { node.to_parent = to_parent; });
  check_subtree(result, edit.node.id);
  Report report;
  if (edit.scale && (edit.scale->value.array() < 0).count() == 2)
    report.lines.emplace_back("note: two negative factors are half a turn, which belongs to the rotation from now on");
  return {std::move(result), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    Place, "Sets a node's position, rotation and scale relative to its parent.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to place");
      visit("position", edit.position, Need::optional, "position of its origin; default: unchanged", Unit::length);
      visit("rotation", edit.rotation, Need::optional, "rotation relative to its parent; default: unchanged");
      visit(
          "scale", edit.scale, Need::optional,
          "factors along its own axes; negative values mirror, 0 is refused; default: unchanged. A mirrored node "
          "counts as "
          "mirrored along the axis, or all three, that leaves the smallest rotation; give scale and rotation together "
          "to be sure");
    })

}  // namespace rebake
