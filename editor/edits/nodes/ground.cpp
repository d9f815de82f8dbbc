#include "editor/edits/nodes/ground.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "editor/edits/describe_edit.h"

namespace rebake {

namespace {

// Area-weighted least-squares plane of the selected triangles. The normal is the eigenvector with the smallest
// eigenvalue of the covariance matrix, to which each triangle contributes its exact integral: A/12 (9 c cᵀ + Σ p pᵀ).
Ground fitted(const std::vector<PlacedNode>& nodes) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const PlacedNode& placed : nodes) {
    std::size_t number = 0;
    for (const TextureSet& set : placed.node->object->sets)
      for (const Face& face : set.soup.faces())
        if ((*placed.node->selection)[number++] != 0)
          triangles.push_back({placed.to_world * set.soup.positions()[face[0]],
                               placed.to_world * set.soup.positions()[face[1]],
                               placed.to_world * set.soup.positions()[face[2]]});
  }
  double area = 0;
  Vec3 centre = Vec3::Zero();
  const Vec3 origin = triangles.front()[0];
  const auto area_of = [](const std::array<Vec3, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2; };
  for (const auto& t : triangles) {
    const double one = area_of(t);
    area += one;
    centre += one * ((t[0] - origin) + (t[1] - origin) + (t[2] - origin)) / 3;
  }
  if (!(area > 0) || !std::isfinite(area)) throw EditError("the selected triangles have no area: no plane fits them");
  centre = origin + centre / area;
  Mat3 covariance = Mat3::Zero();
  for (const auto& t : triangles) {
    const Vec3 a = t[0] - centre, b = t[1] - centre, c = t[2] - centre, sum = a + b + c;
    covariance +=
        area_of(t) / 12 / area * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(covariance);
  if (!(solver.eigenvalues()[1] > 1e-12 * solver.eigenvalues()[2]))
    throw EditError("the selected triangles lie on one line: no plane fits them");
  return ground_through({centre, centre + solver.eigenvectors().col(2), centre + solver.eigenvectors().col(1)});
}

Ground wanted_ground(const Scene& scene, const GroundEdit& edit) {
  if (edit.height) {
    if (!std::isfinite(*edit.height)) throw FieldError("height", "must be finite");
    return {Vec3::UnitY(), *edit.height};
  }
  if (edit.foot) {
    const double lowest = lowest_visible(scene);
    if (!std::isfinite(lowest)) throw EditError("nothing is visible, so there is no lowest point");
    return {Vec3::UnitY(), lowest};
  }
  if (edit.selection)
    return fitted(edit.nodes.empty() ? objects_with_selection(scene, std::nullopt)
                                     : objects_of_each(scene, edit.nodes, objects_with_selection));
  if (edit.points.points.size() != 3)
    throw FieldError("points", fmt::format("must be three points, but has {}", edit.points.points.size()));
  try {
    return ground_through({edit.points.points[0], edit.points.points[1], edit.points.points[2]});
  } catch (const std::invalid_argument& error) {
    throw FieldError("points", error.what());
  }
}

}  // namespace

Outcome apply(const Scene& scene, const GroundEdit& edit) {
  const int given =
      (edit.height ? 1 : 0) + (edit.foot ? 1 : 0) + (edit.selection ? 1 : 0) + (edit.points.points.empty() ? 0 : 1);
  if (given != 1) throw EditError("exactly one of height, foot, selection and points must be given");
  if (!edit.nodes.empty() && !edit.selection) throw FieldError("nodes", "can be given with selection only");
  Scene result = scene;
  set_ground(result, wanted_ground(scene, edit));
  const Vec3 up = result.ground.normal;
  std::string said =
      fmt::format("ground: height {:.6g} along ({:.4g}, {:.4g}, {:.4g})", result.ground.height, up.x(), up.y(), up.z());
  return {std::move(result), {{std::move(said)}}};
}

std::string whole_title(const GroundEdit& /*edit*/) { return "Set the ground plane"; }

REBAKE_DESCRIBE_EDIT(
    GroundEdit,
    "Sets the ground plane for drop, snapping and the grid; its normal is the up direction of sky light. By default, "
    "the ground is y = 0.",
    (auto& edit, auto& visit) {
      visit("height", edit.height, Need::optional, "level plane at this y", Unit::length);
      visit("foot", edit.foot, Need::optional, "level plane at the lowest point of all visible objects");
      visit("selection", edit.selection, Need::optional, "least-squares plane of the selected triangles");
      visit("nodes", edit.nodes, Need::optional,
            "with selection: only triangles of these nodes; default: of all visible, unlocked nodes");
      visit("points", edit.points, Need::optional, "plane through three points");
    })

}  // namespace rebake
