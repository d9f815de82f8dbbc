#include "mesh_ops/formats/motion_samples.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace {

constexpr double samples_per_second = 30, jump = 1e-4;  // a step takes 0.1 ms
constexpr double most_deviation = 1.0 / 500;            // of the diagonal
constexpr std::size_t most_poses = 32;

// Times at which keyframes are sampled. `step`: all of them jump.
template <class Value>
std::vector<double> sample_times(const Keyframes<Value>& keys, bool& step, bool curved) {
  const auto all = [&](Interpolation kind) {
    return std::all_of(keys.begin(), keys.end() - 1, [&](const auto& key) { return key.to_next == kind; });
  };
  step = keys.size() > 1 && all(Interpolation::step);
  std::vector<double> times;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    times.push_back(keys[k].seconds);
    if (k + 1 == keys.size() || step) continue;
    const double next = keys[k + 1].seconds;
    if (keys[k].to_next == Interpolation::step && next - jump > keys[k].seconds) times.push_back(next - jump);
    if (keys[k].to_next == Interpolation::smooth || (curved && keys[k].to_next == Interpolation::linear)) {
      const double length = next - keys[k].seconds;
      const auto count = static_cast<std::size_t>(std::ceil(length * samples_per_second));
      for (std::size_t i = 1; i < count; ++i)
        times.push_back(keys[k].seconds + length * static_cast<double>(i) / static_cast<double>(count));
    }
  }
  return times;
}

void add_rotation(PlaceSamples& samples, Eigen::Quaterniond rotation) {
  // The shorter way to the sample before.
  if (!samples.rotations.empty() && samples.rotations.back().dot(rotation) < 0) rotation.coeffs() = -rotation.coeffs();
  samples.rotations.push_back(rotation.normalized());
}

double farthest(const BakedObject& a, const BakedObject& b, const BakedObject& middle) {
  double result = 0;
  for (std::size_t s = 0; s < middle.sets.size(); ++s) {
    const auto &p = a.sets[s].soup.positions(), &q = b.sets[s].soup.positions(), &m = middle.sets[s].soup.positions();
    for (std::size_t v = 0; v < m.size(); ++v) {
      const double distance = ((p[v] + q[v]) / 2 - m[v]).norm();
      if (std::isfinite(distance)) result = std::max(result, distance);
    }
  }
  return result;
}

}  // namespace

PlaceSamples place_samples(const Keyframes<Affine>& keys) {
  PlaceSamples samples;
  samples.seconds = sample_times(keys, samples.step, false);
  for (const double seconds : samples.seconds) {
    const Affine at = value_at(keys, seconds);
    Mat3 turn = orthogonal_factor(at.linear());
    if (turn.determinant() < 0) turn.col(0) = -turn.col(0);
    const Mat3 stretch = turn.transpose() * at.linear();
    samples.translations.emplace_back(at.translation());
    samples.scales.emplace_back(stretch.diagonal());
    add_rotation(samples, Eigen::Quaterniond(turn));
    constexpr double rounding = 1e-9;
    samples.sheared = samples.sheared || Mat3(stretch - Mat3(stretch.diagonal().asDiagonal())).cwiseAbs().maxCoeff() >
                                             rounding * stretch.cwiseAbs().maxCoeff();
  }
  return samples;
}

PlaceSamples camera_samples(const Keyframes<Camera>& keys) {
  PlaceSamples samples;
  // Even between linear keyframes, the eye moves on an arc about its target.
  samples.seconds = sample_times(keys, samples.step, true);
  for (const double seconds : samples.seconds) {
    const Camera at = value_at(keys, seconds);
    samples.translations.push_back(at.eye);
    samples.scales.emplace_back(1, 1, 1);
    add_rotation(samples, Eigen::Quaterniond(Mat3(world_to_camera(at).transpose())));
  }
  return samples;
}

BendPoses bend_poses(const Node& node) {
  BendPoses result;
  const auto pose = [&](const std::optional<double>& seconds) {
    Node posed = node;
    // Also bends by 0°, so that all poses have the same vertices.
    for (const auto& [name, track] : node.motion->bends)
      posed.object = bent(posed, track, seconds ? value_at(track.degrees, *seconds) : 0);
    return posed.object;
  };
  result.rest = pose(std::nullopt);
  for (const auto& [name, track] : node.motion->bends) {
    bool step = false;
    Keyframes<double> keys = track.degrees;
    // Only keyframes and jumps: the times between are found below.
    for (auto& key : keys)
      if (key.to_next == Interpolation::smooth) key.to_next = Interpolation::linear;
    const std::vector<double> times = sample_times(keys, step, false);
    result.seconds.insert(result.seconds.end(), times.begin(), times.end());
    if (step)
      for (std::size_t k = 1; k < keys.size(); ++k) result.seconds.push_back(keys[k].seconds - jump);
  }
  std::sort(result.seconds.begin(), result.seconds.end());
  result.seconds.erase(std::unique(result.seconds.begin(), result.seconds.end()), result.seconds.end());
  for (const double seconds : result.seconds) result.poses.push_back(pose(seconds));
  const double allowed = most_deviation * result.rest->bounds().diagonal().norm();
  for (std::size_t k = 0; k + 1 < result.poses.size();) {
    if (result.seconds[k + 1] - result.seconds[k] < 2 * jump) {  // a step, which is meant to jump
      ++k;
      continue;
    }
    const double middle = (result.seconds[k] + result.seconds[k + 1]) / 2;
    const auto between = pose(middle);
    const double deviation = farthest(*result.poses[k], *result.poses[k + 1], *between);
    if (deviation > allowed && result.poses.size() < most_poses) {
      const auto at = static_cast<std::ptrdiff_t>(k) + 1;
      result.seconds.insert(result.seconds.begin() + at, middle);
      result.poses.insert(result.poses.begin() + at, between);
      continue;
    }
    result.deviation = std::max(result.deviation, deviation);
    ++k;
  }
  return result;
}

}  // namespace rebake
