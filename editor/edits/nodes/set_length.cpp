#include "editor/edits/nodes/set_length.h"

#include <fmt/format.h>

#include <cmath>

#include "editor/edits/describe_edit.h"

namespace rebake {

Outcome apply(const Scene& scene, const SetLength& edit) {
  const std::vector<Vec3>& points = edit.points.points;
  if (points.size() != 2) throw FieldError("points", fmt::format("must be two points, but has {}", points.size()));
  if (!(edit.length > 0) || !std::isfinite(edit.length)) throw FieldError("length", "must be above 0");
  const double before = (points[1] - points[0]).stableNorm();
  if (!(before > 0)) throw FieldError("points", "coincide: they must be apart");
  const double factor = edit.length / before;
  if (!std::isfinite(factor) || factor == 0) throw FieldError("length", "is too far from the present length");
  Scene result = scene;
  Report report;
  for (const NodePtr& root : scene.roots) {
    if (root->locked)
      throw EditError(fmt::format("\"{}\" is locked; unlock it first, because the whole scene is scaled", root->name));
    result = with_changed(result, root->id,
                          [&](Node& node) { move_in_parent(node, Affine(Eigen::UniformScaling<double>(factor))); });
    check_subtree(result, root->id);
    for (std::string& line : locked_inside(scene, root->id)) report.lines.push_back(std::move(line));
  }
  const auto scale = [&](Camera& camera) {
    camera.eye *= factor;
    camera.target *= factor;
    camera.near_plane *= factor;
    camera.far_plane *= factor;
    camera.ortho_height *= factor;
  };
  for (auto& [name, camera] : result.views) scale(camera);
  for (auto& key : result.camera_keys) scale(key.value);
  result.ground.height *= factor;
  report.lines.push_back(
      fmt::format("{:.6g} became {:.6g}; the scene is scaled by {:.6g}", before, edit.length, factor));
  return {std::move(result), std::move(report)};
}

std::string whole_title(const SetLength& /*edit*/) { return "Set a length"; }

REBAKE_DESCRIBE_EDIT(
    SetLength,
    "Scales the whole scene about the origin, with its views and ground, so that two points get a known distance.",
    (auto& edit, auto& visit) {
      visit("points", edit.points, Need::required, "two points");
      visit("length", edit.length, Need::required, "their real distance", Unit::length);
    })

}  // namespace rebake
