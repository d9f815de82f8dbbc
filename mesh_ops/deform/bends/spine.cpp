#include "mesh_ops/deform/bends/spine.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <utility>

namespace rebake {

namespace {

constexpr double cells = 32;        // cells per diagonal of the part; points in the same or adjacent cells touch
constexpr double elongated = 1.5;   // ratio of standard deviations above which a part is elongated
constexpr double near_foot = 0.15;  // share of the length over which the width is measured

struct Mean {
  Vec3 sum{0, 0, 0};
  double weight = 0;
  void add(const WeightedPoint& point) {
    sum += point.weight * point.at;
    weight += point.weight;
  }
  Vec3 value() const { return sum / weight; }
};

// The points of the rest that touch the part.
std::vector<WeightedPoint> contacts_of(const std::vector<WeightedPoint>& part, const std::vector<WeightedPoint>& rest,
                                       const Box& box) {
  const double cell = box.diagonal().norm() / cells;
  const auto key = [&](const Vec3& p, int dx, int dy, int dz) {
    const auto index = [&](int axis, int step) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor((p[axis] - box.min()[axis]) / cell)) +
                                        step + 4);
    };
    return index(0, dx) | index(1, dy) << 20 | index(2, dz) << 40;
  };
  std::unordered_set<std::uint64_t> taken;
  for (const WeightedPoint& point : part) taken.insert(key(point.at, 0, 0, 0));
  std::vector<WeightedPoint> contacts;
  const Box near(Vec3(box.min() - Vec3::Constant(2 * cell)), Vec3(box.max() + Vec3::Constant(2 * cell)));
  for (const WeightedPoint& point : rest) {
    if (!near.contains(point.at)) continue;
    bool touches = false;
    for (int dx = -1; dx <= 1 && !touches; ++dx)
      for (int dy = -1; dy <= 1 && !touches; ++dy)
        for (int dz = -1; dz <= 1 && !touches; ++dz) touches = taken.contains(key(point.at, dx, dy, dz));
    if (touches) contacts.push_back(point);
  }
  return contacts;
}

// Centres of the part at equal steps along the line, each from the points within a step (linear weights).
std::vector<Vec3> curve_of(const std::vector<WeightedPoint>& part, const Spine& spine) {
  constexpr std::size_t steps = 8;
  std::vector<Mean> near(steps + 1);
  for (const WeightedPoint& point : part) {
    const double at =
        std::clamp((point.at - spine.foot).dot(spine.along) / spine.length, 0.0, 1.0) * static_cast<double>(steps);
    const std::size_t k = std::min(static_cast<std::size_t>(at), steps - 1);
    const double share = at - static_cast<double>(k);
    near[k].add({point.at, point.weight * (1 - share)});
    near[k + 1].add({point.at, point.weight * share});
  }
  std::vector<Vec3> middles;
  for (const Mean& one : near)
    if (one.weight > 0) middles.push_back(one.value());
  if (middles.size() < 3) return {spine.foot, spine.foot + spine.length * spine.along};
  // Smoothing, so that outliers such as single leaves have little effect.
  std::vector<Vec3> curve = middles;
  for (std::size_t k = 1; k + 1 < middles.size(); ++k)
    curve[k] = (middles[k - 1] + 2 * middles[k] + middles[k + 1]) / 4;
  // Extends the curve to the ends of the part.
  const auto along = [&](const Vec3& p) { return (p - spine.foot).dot(spine.along); };
  const auto extend = [&](Vec3& end, const Vec3& before, double to) {
    const double step = along(end) - along(before);
    if (step != 0) end += (to - along(end)) / step * (end - before);
  };
  extend(curve.front(), curve[1], 0);
  extend(curve.back(), curve[curve.size() - 2], spine.length);
  return curve;
}

}  // namespace

std::optional<Spine> spine_of(const std::vector<WeightedPoint>& part, const std::vector<WeightedPoint>& rest) {
  Mean mean;
  Box box;
  for (const WeightedPoint& point : part) {
    mean.add(point);
    box.extend(point.at);
  }
  if (box.isEmpty() || !(mean.weight > 0) || !(box.diagonal().norm() > 0)) return std::nullopt;
  const Vec3 middle = mean.value();
  Mat3 spread = Mat3::Zero();
  for (const WeightedPoint& point : part)
    spread += point.weight * (point.at - middle) * (point.at - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread / mean.weight);
  const std::vector<WeightedPoint> contacts = contacts_of(part, rest, box);
  Mean touching;
  for (const WeightedPoint& point : contacts) touching.add(point);
  const std::optional<Vec3> contact = contacts.empty() ? std::nullopt : std::optional(touching.value());
  Spine spine;
  spine.along = axes.eigenvectors().col(2);
  const bool round = !(std::sqrt(axes.eigenvalues()[2]) > elongated * std::sqrt(std::max(0.0, axes.eigenvalues()[1])));
  if (round && contact && (middle - *contact).norm() > 0.05 * box.diagonal().norm())
    spine.along = (middle - *contact).normalized();
  // Points away from the rest, or upwards if nothing touches.
  const double side = contact ? (middle - *contact).dot(spine.along) : spine.along.y();
  if (side < 0) spine.along = -spine.along;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const WeightedPoint& point : part) {
    const double at = (point.at - middle).dot(spine.along);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  spine.foot = middle + low * spine.along;
  spine.length = high - low;
  if (!(spine.length > 0)) return std::nullopt;
  if (contact) {
    // The range from the 5th to the 95th percentile of contacts, by weight.
    std::vector<std::pair<double, double>> along;
    for (const WeightedPoint& point : contacts)
      along.emplace_back((point.at - spine.foot).dot(spine.along) / spine.length, point.weight);
    std::sort(along.begin(), along.end());
    const auto at_weight = [&](double share) {
      double sum = 0;
      for (const auto& [place, weight] : along) {
        sum += weight;
        if (sum >= share * touching.weight) return place;
      }
      return along.back().first;
    };
    spine.touched = std::clamp(at_weight(0.95), 0.0, 1.0) - std::clamp(at_weight(0.05), 0.0, 1.0);
  }
  double distances = 0, weights = 0;
  for (const WeightedPoint& point : part) {
    const Vec3 from_foot = point.at - spine.foot;
    const double at = from_foot.dot(spine.along);
    if (at > near_foot * spine.length) continue;
    distances += point.weight * (from_foot - at * spine.along).norm();
    weights += point.weight;
  }
  if (weights > 0) spine.width = 2 * distances / weights;
  spine.curve = curve_of(part, spine);
  return spine;
}

}  // namespace rebake
