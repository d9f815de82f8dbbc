#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "editor/studies/study.h"
#include "mesh_ops/registration/trimmed_icp.h"

namespace rebake {

namespace {

// Places of samples along the longest side of the scene, as a share of it.
double along(const Vec3& point, const Box& box, Eigen::Index axis) {
  return (point[axis] - box.min()[axis]) / box.sizes()[axis];
}

// The samples from `first` to `last` of the scene's longest side, of which a share becomes random points in its box.
SurfaceSamples part_of(const SurfaceSamples& all, const Box& box, double first, double last, double outliers,
                       unsigned seed) {
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::mt19937 random(seed);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  SurfaceSamples part;
  for (std::size_t k = 0; k < all.points.size(); ++k) {
    const double at = along(all.points[k], box, axis);
    if (at < first || at > last) continue;
    const bool floats = share() < outliers;
    const Vec3 random_place = box.min() + Vec3(share(), share(), share()).cwiseProduct(box.sizes());
    part.points.push_back(floats ? random_place : all.points[k]);
    part.normals.push_back(all.normals[k]);
  }
  return part;
}

}  // namespace

// Two captures are parts of the scene that share a strip, each with samples of its own. One starts rotated by 2°, moved
// by 1 % of the diagonal and 2 % too large, as after picking pairs.
StudyTable study_register(const StudyInput& input) {
  StudyTable table{{"ms", "error % of the diagonal", "error in degrees", "common length %", "outliers %", "samples",
                    "overlap found %"},
                   {},
                   0,
                   1,
                   true,
                   true};
  const std::vector<PlacedNode> nodes = placed_nodes(input.scene);
  const Box box = world_bounds(input.scene);
  const double diagonal = box.diagonal().norm();
  Similarity start;
  start.center = box.center();
  start.rotation = Eigen::AngleAxisd(2 * std::numbers::pi / 180, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  start.scale = 1.02;
  start.shift = 0.01 * diagonal * Vec3(1, -1, 1).normalized();
  for (const std::size_t samples : {2000U, 10000U, 50000U}) {
    // Parts of the scene get their share of the samples.
    const SurfaceSamples from = sampled_surfaces(nodes, samples, 1), onto = sampled_surfaces(nodes, 5 * samples, 2);
    for (const double overlap : {0.2, 0.5, 1.0})
      for (const double outliers : {0.0, 0.05, 0.2}) {
        input.progress.at("registering", static_cast<double>(table.rows.size()) / 27);
        // Both captures are equally long: a share of `overlap` of each is common.
        const double length = 1 / (2 - overlap);
        const SurfaceSamples fixed = part_of(onto, box, 0, length, outliers, 3);
        SurfaceSamples moved = part_of(from, box, 1 - length, 1, outliers, 4);
        const std::vector<Vec3> places = moved.points;
        for (Vec3& point : moved.points) point = start(point);
        for (Vec3& normal : moved.normals) normal = start.rotation * normal;
        IcpResult result;
        const double time =
            median_milliseconds(std::min(input.frames, 3), [&] { result = trimmed_icp(moved, fixed, {}); });
        double error = 0;
        for (std::size_t k = 0; k < places.size(); ++k)
          error = std::max(error, (result.motion(moved.points[k]) - places[k]).norm() / diagonal);
        const double degrees =
            Eigen::AngleAxisd(result.motion.rotation * start.rotation).angle() * 180 / std::numbers::pi;
        table.rows.push_back(
            {fmt::format("{} samples, {:g} % common, {:g} % outliers", samples, overlap * 100, outliers * 100),
             {time, error * 100, degrees, overlap * 100, outliers * 100, static_cast<double>(samples),
              result.overlap * 100}});
      }
  }
  return table;
}

}  // namespace rebake
