#include "mesh_ops/registration/trimmed_icp.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mesh_ops/base/error.h"
#include "mesh_ops/registration/nearest_samples.h"

namespace rebake {

namespace {

using Step = Eigen::Matrix<double, 7, 1>;  // rotation vector, translation, logarithm of the scale
using Normal7 = Eigen::Matrix<double, 7, 7>;

constexpr std::size_t least_points = 50;
constexpr double least_overlap = 0.05;
constexpr double least_cosine = 0.5;  // of the normals of counterparts
// Exponent of the fractional RMSD for surfaces in space.
constexpr double overlap_exponent = 0.95;
// Eigenvalues of the normal equations below this share of the largest count as sliding.
constexpr double sliding = 1e-6;

struct Match {
  std::size_t fixed = 0;
  double squared = std::numeric_limits<double>::infinity();  // distance of the points
};

Box box_of(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

// Number of matches to use, which are sorted by distance.
std::size_t used_matches(const std::vector<Match>& matches, const std::vector<std::size_t>& order, double floor,
                         const std::optional<double>& overlap) {
  const auto all = static_cast<double>(order.size());
  if (overlap) return std::clamp<std::size_t>(static_cast<std::size_t>(*overlap * all), least_points, order.size());
  double sum = 0, best = std::numeric_limits<double>::infinity();
  std::size_t count = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double squared = matches[order[k]].squared;
    if (!std::isfinite(squared)) break;
    // Distances below the spacing of samples say nothing.
    sum += squared + floor;
    const double share = static_cast<double>(k + 1) / all;
    if (share < least_overlap || k + 1 < least_points) continue;
    const double error = std::sqrt(sum / static_cast<double>(k + 1)) / std::pow(share, overlap_exponent);
    if (error < best) {
      best = error;
      count = k + 1;
    }
  }
  return count;
}

class Icp {
 public:
  Icp(const SurfaceSamples& moved, const SurfaceSamples& fixed, const IcpOptions& options)
      : moved_(moved), fixed_(fixed), options_(options), tree_(fixed.points), matches_(moved.points.size()) {
    const Box box = box_of(moved.points);
    result_.motion.center = box.center();
    radius_ = box.diagonal().norm() / 2;
    // Mean distance of nearest samples on a plane: half the spacing.
    const double spacing = box_of(fixed.points).diagonal().norm() / std::sqrt(static_cast<double>(fixed.points.size()));
    floor_ = spacing * spacing / 4;
  }

  IcpResult run(const Progress& progress) {
    for (; result_.iterations < options_.iterations && !result_.converged; ++result_.iterations) {
      progress.at("registering", static_cast<double>(result_.iterations) / options_.iterations);
      match();
      const double change = step();
      // A change that moves no point by more than rounding does.
      result_.converged = change < 1e-10 * radius_;
    }
    match();
    measure();
    return result_;
  }

 private:
  Vec3 placed(std::size_t k) const { return result_.motion(moved_.points[k]); }

  // Finds the counterparts, and the number of those that are used.
  void match() {
    tbb::parallel_for(std::size_t{0}, matches_.size(), [&](std::size_t k) {
      const Vec3 at = placed(k);
      const std::size_t nearest = tree_.nearest(at);
      const double cosine = std::abs((result_.motion.rotation * moved_.normals[k]).dot(fixed_.normals[nearest]));
      matches_[k] = {nearest, cosine < least_cosine ? std::numeric_limits<double>::infinity()
                                                    : (at - fixed_.points[nearest]).squaredNorm()};
    });
    order_.resize(matches_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(matches_[a].squared, a) < std::pair(matches_[b].squared, b);
    });
    used_ = used_matches(matches_, order_, floor_, options_.overlap);
    while (used_ > 0 && !std::isfinite(matches_[order_[used_ - 1]].squared)) --used_;
    if (used_ < least_points) throw Error("the surfaces do not overlap: pick pairs that bring them together");
  }

  double plane_distance(std::size_t k) const {
    const std::size_t f = matches_[k].fixed;
    return fixed_.normals[f].dot(placed(k) - fixed_.points[f]);
  }

  // One Gauss–Newton step. Returns the largest motion of a point of the box.
  double step() {
    const Vec3 center = result_.motion.center + result_.motion.shift;
    Normal7 normal = Normal7::Zero();
    Step right = Step::Zero();
    for (std::size_t n = 0; n < used_; ++n) {
      const std::size_t k = order_[n], f = matches_[k].fixed;
      // In units of the radius, so that rotations, translations and scales are comparable.
      const Vec3 arm = (placed(k) - center) / radius_;
      const Vec3& plane = fixed_.normals[f];
      Step row;
      row << arm.cross(plane), plane, options_.with_scale ? plane.dot(arm) : 0;
      normal += row * row.transpose();
      right -= row * (plane_distance(k) / radius_);
    }
    const Eigen::SelfAdjointEigenSolver<Normal7> solver(normal);
    const double largest = solver.eigenvalues()[6];
    Step change = Step::Zero();
    result_.free_directions = options_.with_scale ? 0 : -1;
    for (int e = 0; e < 7; ++e) {
      if (!(solver.eigenvalues()[e] > sliding * largest)) {
        ++result_.free_directions;
        continue;
      }
      change += solver.eigenvectors().col(e) * (solver.eigenvectors().col(e).dot(right) / solver.eigenvalues()[e]);
    }
    const double angle = change.head<3>().norm();
    Similarity& motion = result_.motion;
    if (angle > 0) motion.rotation = Eigen::AngleAxisd(angle, change.head<3>() / angle) * motion.rotation;
    motion.rotation = Eigen::Quaterniond(motion.rotation).normalized().toRotationMatrix();
    motion.scale *= std::exp(change[6]);
    motion.shift += radius_ * change.segment<3>(3);
    return radius_ * change.norm();
  }

  void measure() {
    double sum = 0;
    for (std::size_t n = 0; n < used_; ++n) sum += plane_distance(order_[n]) * plane_distance(order_[n]);
    result_.rms = std::sqrt(sum / static_cast<double>(used_));
    result_.overlap = static_cast<double>(used_) / static_cast<double>(matches_.size());
  }

  const SurfaceSamples& moved_;
  const SurfaceSamples& fixed_;
  const IcpOptions& options_;
  NearestSamples tree_;
  std::vector<Match> matches_;
  std::vector<std::size_t> order_;  // of matches, by distance
  std::size_t used_ = 0;
  double radius_ = 1, floor_ = 0;
  IcpResult result_;
};

}  // namespace

IcpResult trimmed_icp(const SurfaceSamples& moved, const SurfaceSamples& fixed, const IcpOptions& options,
                      const Progress& progress) {
  if (moved.points.size() < least_points || fixed.points.size() < least_points)
    throw Error("there are too few opaque surfaces to register");
  return Icp(moved, fixed, options).run(progress);
}

}  // namespace rebake
