#include "editor/studies/posed_body.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "editor/studies/study_soup.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/bends/closed_form.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "mesh_ops/deform/cages/wrap.h"
#include "mesh_ops/light/learned/body_image.h"
#include "mesh_ops/light/relight/cached_light.h"

namespace rebake {

namespace {

PosedBody in_lattice(std::string name, ProxyMesh rest) {
  Box box = bounds(rest);
  const Vec3 room = Vec3::Constant(0.05 * box.diagonal().norm());
  box = Box(box.min() - room, box.max() + room);
  // Two cells along the shortest side, three along the others.
  std::array<int, 3> cells{3, 3, 3};
  Eigen::Index min_reliable_height = 0;
  box.sizes().minCoeff(&min_reliable_height);
  cells[static_cast<std::size_t>(min_reliable_height)] = 2;
  PosedBody body{std::move(name), std::move(rest), lattice_cage(box, cells[0], cells[1], cells[2]), nullptr, {}};
  body.coordinates = mean_value_coordinates(body.cage);
  return body;
}

}  // namespace

ProxyMesh PosedBody::random_pose(std::uint32_t seed, double amplitude) const {
  std::mt19937 random(seed);
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  const double deviation = amplitude * box.sizes().maxCoeff();
  // Box–Muller transform (1958): std::normal_distribution differs between standard libraries.
  const auto uniform = [&] { return (random() + 0.5) / 4294967296.0; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  std::vector<Vec3> moved = cage.vertices;
  for (Vec3& v : moved)
    for (int axis = 0; axis < 3; ++axis) v[axis] += deviation * normal();
  return {deform_points(*coordinates, cage, moved, rest.vertices, false).points, rest.faces};
}

ProxyMesh PosedBody::bent(double degrees) const {
  const Box box = bounds(rest);
  Eigen::Index longest = 0, min_reliable_height = 0;
  box.sizes().maxCoeff(&longest);
  box.sizes().minCoeff(&min_reliable_height);
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.origin = box.center();
  form.axis = Vec3::Unit(longest);
  form.direction = Vec3::Unit(min_reliable_height);
  form.from = -box.sizes()[longest] / 2;
  form.to = box.sizes()[longest] / 2;
  form.radians = degrees * std::numbers::pi / 180;
  ProxyMesh result{{}, rest.faces};
  for (const Vec3& v : rest.vertices) result.vertices.push_back(deform(form, v).point);
  return result;
}

PosedBody bumpy_sheet(int side) {
  ProxyMesh mesh;
  const std::array<std::array<double, 4>, 6> bumps{{{-0.5, -0.4, 0.22, 0.35},
                                                    {0.35, 0.45, 0.26, 0.4},
                                                    {0.5, -0.5, 0.18, 0.3},
                                                    {-0.35, 0.5, 0.2, -0.3},
                                                    {0.0, 0.0, 0.15, 0.3},
                                                    {0.75, 0.05, 0.15, 0.25}}};  // x, y, radius, height
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const double x = 2.0 * column / (side - 1) - 1, y = 2.0 * row / (side - 1) - 1;
      double z = 0;
      for (const auto& [cx, cy, radius, height] : bumps)
        z += height * std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (2 * radius * radius));
      mesh.vertices.emplace_back(x, y, z);
      if (row + 1 == side || column + 1 == side) continue;
      const auto a = static_cast<std::uint32_t>(row * side + column), b = a + static_cast<std::uint32_t>(side);
      mesh.faces.push_back({a, a + 1, b + 1});
      mesh.faces.push_back({a, b + 1, b});
    }
  PosedBody body = in_lattice("sheet", std::move(mesh));
  body.chart = grid_chart(side);
  return body;
}

PosedBody wrapped_part(const Scene& scene, const Box& shares, double coarseness) {
  const StudySoup soup = study_soup(scene);
  Box all;
  for (const Vec3& p : soup.places) all.extend(p);
  const Box box(all.min() + all.sizes().cwiseProduct(shares.min()), all.min() + all.sizes().cwiseProduct(shares.max()));
  TriangleList part{soup.opaque.points, {}};
  for (const Face& face : soup.opaque.faces)
    if (box.contains((part.points[face[0]] + part.points[face[1]] + part.points[face[2]]) / 3))
      part.faces.push_back(face);
  if (part.faces.empty())
    throw Error("the studied part of the scene has no opaque triangle; pass another scene with --scene");
  PosedBody body = in_lattice("branch", largest_component(wrap(part, coarseness)));
  body.chart = disk_chart(body.rest);
  return body;
}

TracedPose traced_pose(const ProxyMesh& rest, const ProxyMesh& posed, int rays, const Progress& progress) {
  TracedPose pose;
  pose.turns = vertex_rotations(rest, posed);
  pose.sites = vertex_sites(rest, posed, pose.turns);
  pose.transfer = traced_transfer(pose.sites, rays_among({{solid_object(posed), Affine::Identity()}}), rays, progress);
  return pose;
}

}  // namespace rebake
