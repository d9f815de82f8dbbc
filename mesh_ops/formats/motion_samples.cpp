#include "mesh_ops/formats/motion_samples.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace {

constexpr double samples_per_second = 30, jump = 1e-4;  // a step takes 0.1 ms
constexpr double most_deviation = 1.0 / 500;            // of the diagonal
constexpr double most_of_travel = 1.0 / 50;             // of the farthest way of a vertex
constexpr double most_samples = 20000;
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
      const double rate = std::min(samples_per_second, most_samples / keys.back().seconds);
      const auto count = static_cast<std::size_t>(std::ceil(length * rate));
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

// Calls visit(a, b, c) with the positions of each corner in three objects of the same faces.
template <class Visit>
void for_corners(const BakedObject& a, const BakedObject& b, const BakedObject& c, Visit visit) {
  for (std::size_t s = 0; s < c.sets.size(); ++s) {
    const Soup &p = a.sets[s].soup, &q = b.sets[s].soup, &r = c.sets[s].soup;
    for (std::size_t f = 0; f < r.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k)
        visit(p.positions()[p.faces()[f][k]], q.positions()[q.faces()[f][k]], r.positions()[r.faces()[f][k]]);
  }
}

// Largest distance of a corner from its place `share` of the way between a and b.
double farthest(const BakedObject& a, const BakedObject& b, double share, const BakedObject& exact) {
  double result = 0;
  for_corners(a, b, exact, [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    const double distance = ((1 - share) * p + share * q - r).norm();
    if (std::isfinite(distance)) result = std::max(result, distance);
  });
  return result;
}

// Vertices that corners share only if they do so in all objects of the same faces.
struct CommonVertices {
  Soup::Faces faces;
  std::size_t count = 0;
};
CommonVertices common_vertices(const std::vector<const Soup*>& soups) {
  const std::size_t triangles = soups.front()->triangle_count();
  std::vector<Face> faces = soups.front()->faces();
  std::size_t count = soups.front()->positions().size();
  for (const Soup* soup : soups) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    for (std::size_t f = 0; f < triangles; ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto number = static_cast<std::uint32_t>(known.size());
        faces[f][k] = known.try_emplace({faces[f][k], soup->faces()[f][k]}, number).first->second;
      }
    count = known.size();
  }
  return {std::make_shared<const std::vector<Face>>(std::move(faces)), count};
}

// `object` with these vertices per set.
std::shared_ptr<const BakedObject> with_vertices(const BakedObject& object, const std::vector<CommonVertices>& common) {
  auto made = std::make_shared<BakedObject>(object);
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const Soup& from = object.sets[s].soup;
    std::vector<std::uint32_t> source(common[s].count, 0);
    for (std::size_t f = 0; f < from.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k) source[(*common[s].faces)[f][k]] = from.faces()[f][k];
    auto positions = std::make_shared<std::vector<Vec3>>();
    auto uvs = std::make_shared<std::vector<Vec2>>();
    for (const std::uint32_t v : source) {
      positions->push_back(from.positions()[v]);
      uvs->push_back(from.uvs()[v]);
    }
    made->sets[s].soup =
        Soup(positions, uvs, common[s].faces, from.vertex_attributes().picked(source), from.face_attributes());
  }
  return made;
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

namespace {

// Times of keyframes and jumps of all bends, sorted.
std::vector<double> bend_times(const NodeMotion& motion) {
  std::vector<double> all;
  for (const auto& [name, track] : motion.bends) {
    bool step = false;
    Keyframes<double> keys = track.degrees;
    // The times between smooth keyframes are found by their deviation.
    for (auto& key : keys)
      if (key.to_next == Interpolation::smooth) key.to_next = Interpolation::linear;
    const std::vector<double> times = sample_times(keys, step, false);
    all.insert(all.end(), times.begin(), times.end());
    if (step)
      for (std::size_t k = 1; k < keys.size(); ++k)
        if (keys[k].seconds - jump > keys[k - 1].seconds) all.push_back(keys[k].seconds - jump);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

BendPoses bend_poses(const Node& node) {
  BendPoses result;
  const auto pose = [&](double seconds) {
    return bent(node, [&](const BendTrack& track) { return value_at(track.degrees, seconds); });
  };
  result.seconds = bend_times(*node.motion);
  double travel = 0;
  for (const double seconds : result.seconds) {
    result.poses.push_back(pose(seconds));
    travel = std::max(travel, farthest(*node.object, *node.object, 0, *result.poses.back()));
  }
  const double allowed = std::min(most_deviation * node.object->bounds().diagonal().norm(), travel * most_of_travel);
  for (std::size_t k = 0; k + 1 < result.poses.size();) {
    const double length = result.seconds[k + 1] - result.seconds[k];
    if (length < 2 * jump) {  // a step, which is meant to jump
      ++k;
      continue;
    }
    // Half-way, smooth motion and linear motion can agree.
    double deviation = 0;
    for (const double share : {0.25, 0.5, 0.75})
      deviation = std::max(deviation, farthest(*result.poses[k], *result.poses[k + 1], share,
                                               *pose(result.seconds[k] + share * length)));
    if (deviation > allowed && result.poses.size() < most_poses) {
      const double middle = result.seconds[k] + length / 2;
      const auto at = static_cast<std::ptrdiff_t>(k) + 1;
      result.seconds.insert(result.seconds.begin() + at, middle);
      result.poses.insert(result.poses.begin() + at, pose(middle));
      continue;
    }
    result.deviation = std::max(result.deviation, deviation);
    ++k;
  }
  // Bends split corners that bent and unbent triangles share, each pose its own.
  std::vector<CommonVertices> common;
  for (std::size_t s = 0; s < node.object->sets.size(); ++s) {
    std::vector<const Soup*> soups{&node.object->sets[s].soup};
    for (const auto& one : result.poses) soups.push_back(&one->sets[s].soup);
    common.push_back(common_vertices(soups));
  }
  for (auto& one : result.poses) one = with_vertices(*one, common);
  result.rest = with_vertices(*node.object, common);
  return result;
}

}  // namespace rebake
