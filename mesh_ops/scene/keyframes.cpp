#include "mesh_ops/scene/keyframes.h"

#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

// The part of a track around a time: between keyframes `left` and `left + 1`, at `share` of the way.
struct Segment {
  std::size_t left = 0;
  double share = 0, length = 1;
};

// Nothing if the value is that of keyframe `at`.
template <class Value>
std::optional<Segment> segment_at(const Keyframes<Value>& keys, double seconds, std::size_t& at) {
  const auto next = std::upper_bound(keys.begin(), keys.end(), seconds,
                                     [](double time, const Keyframe<Value>& key) { return time < key.seconds; });
  at = next == keys.begin() ? 0 : static_cast<std::size_t>(next - keys.begin()) - 1;
  if (next == keys.begin() || next == keys.end() || keys[at].seconds == seconds ||
      keys[at].to_next == Interpolation::step)
    return std::nullopt;
  const double length = next->seconds - keys[at].seconds;
  return Segment{at, (seconds - keys[at].seconds) / length, length};
}

// Slope of a monotone cubic at a point between two chords of slopes `before` and `after` over the lengths `a` and `b`
// (Fritsch and Butland 1984).
double slope_between(double before, double after, double a, double b) {
  if (!(before * after > 0)) return 0;
  const double w1 = 2 * b + a, w2 = b + 2 * a;
  return (w1 + w2) / (w1 / before + w2 / after);
}

// A component of the values at a time; `of(k)` is that of keyframe k.
template <class Value>
double component_at(const Keyframes<Value>& keys, const Segment& at, const std::function<double(std::size_t)>& of) {
  const double p = of(at.left), q = of(at.left + 1), t = at.share;
  if (keys[at.left].to_next == Interpolation::linear || p == q) return p + t * (q - p);
  const auto slope = [&](std::size_t k) {
    if (k == 0 || k + 1 == keys.size()) return 0.0;
    const double a = keys[k].seconds - keys[k - 1].seconds, b = keys[k + 1].seconds - keys[k].seconds;
    return slope_between((of(k) - of(k - 1)) / a, (of(k + 1) - of(k)) / b, a, b);
  };
  const double m = slope(at.left) * at.length, n = slope(at.left + 1) * at.length, s = 1 - t;
  return p * s * s * (1 + 2 * t) + q * t * t * (1 + 2 * s) + m * t * s * s - n * s * t * t;
}

// Rotation vector of the shortest rotation from a to b, in the frame of a.
Vec3 way(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::Quaterniond between = a.conjugate() * b;
  if (between.w() < 0) between.coeffs() = -between.coeffs();
  const double sine = between.vec().norm();
  // atan2 keeps small angles exact.
  return sine > 0 ? Vec3(between.vec() / sine * (2 * std::atan2(sine, between.w()))) : Vec3(Vec3::Zero());
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& from, const Vec3& vector) {
  const double angle = vector.norm();
  return angle > 0 ? (from * Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle))).normalized() : from;
}

Eigen::Quaterniond between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double share) {
  return turned(a, share * way(a, b));
}

template <class Value>
Eigen::Quaterniond rotation_at(const Keyframes<Value>& keys, const Segment& at,
                               const std::function<Eigen::Quaterniond(std::size_t)>& of) {
  const Eigen::Quaterniond a = of(at.left), d = of(at.left + 1);
  if (keys[at.left].to_next == Interpolation::linear) return between(a, d, at.share);
  // Angular velocity at a keyframe, in its own frame: zero at the ends and where the rotation rests or turns back.
  const auto velocity = [&](std::size_t k) -> Vec3 {
    if (k == 0 || k + 1 == keys.size()) return Vec3::Zero();
    const double before_length = keys[k].seconds - keys[k - 1].seconds,
                 after_length = keys[k + 1].seconds - keys[k].seconds;
    const Vec3 before = -way(of(k), of(k - 1)) / before_length, after = way(of(k), of(k + 1)) / after_length;
    if (!(before.dot(after) > 0)) return Vec3::Zero();
    const Vec3 mean = (before * after_length + after * before_length) / (before_length + after_length);
    // At most three times the slower chord, as for numbers.
    const double most = 3 * std::min(before.norm(), after.norm());
    return mean.norm() > most ? Vec3(mean * (most / mean.norm())) : mean;
  };
  const Eigen::Quaterniond b = turned(a, velocity(at.left) * at.length / 3),
                           c = turned(d, -velocity(at.left + 1) * at.length / 3);
  const double t = at.share;
  const Eigen::Quaterniond ab = between(a, b, t), bc = between(b, c, t), cd = between(c, d, t);
  return between(between(ab, bc, t), between(bc, cd, t), t);
}

// Polar factors of a transform: `rotation` is proper, and `stretch` symmetric, negative definite if mirrored.
struct Factors {
  Eigen::Quaterniond rotation;
  Mat3 stretch;
  bool mirrored;
};
Factors factors_of(const Affine& affine) {
  Mat3 turn;
  try {
    turn = orthogonal_factor(affine.linear());
  } catch (const std::invalid_argument&) {
    throw Error("a keyframe's transform is singular or not finite");
  }
  const bool mirrored = turn.determinant() < 0;
  if (mirrored) turn = -turn;
  return {Eigen::Quaterniond(turn).normalized(), turn.transpose() * affine.linear(), mirrored};
}

}  // namespace

bool operator==(const BendTrack& a, const BendTrack& b) {
  const auto same_box = [](const std::optional<Box>& x, const std::optional<Box>& y) {
    return x.has_value() == y.has_value() && (!x || (x->min() == y->min() && x->max() == y->max()));
  };
  return a.selection == b.selection && same_box(a.box, b.box) && a.to_box.matrix() == b.to_box.matrix() &&
         a.to_space.matrix() == b.to_space.matrix() && a.falloff == b.falloff && a.origin == b.origin &&
         a.axis == b.axis && a.direction == b.direction && a.from == b.from && a.to == b.to && a.spine == b.spine &&
         a.degrees == b.degrees;
}

double value_at(const Keyframes<double>& keys, double seconds) {
  std::size_t nearest = 0;
  const auto at = segment_at(keys, seconds, nearest);
  if (!at) return keys[nearest].value;
  return component_at(keys, *at, [&](std::size_t k) { return keys[k].value; });
}

Affine value_at(const Keyframes<Affine>& keys, double seconds) {
  std::size_t nearest = 0;
  const auto at = segment_at(keys, seconds, nearest);
  if (!at) return keys[nearest].value;
  // Smooth values depend on one keyframe more on each side.
  const std::size_t first = at->left == 0 ? 0 : at->left - 1, last = std::min(at->left + 2, keys.size() - 1);
  std::vector<Factors> factors;
  for (std::size_t k = first; k <= last; ++k) factors.push_back(factors_of(keys[k].value));
  const auto factor = [&](std::size_t k) -> const Factors& { return factors[k - first]; };
  if (factor(at->left).mirrored != factor(at->left + 1).mirrored)
    throw Error("keyframes cannot interpolate between a mirrored and an unmirrored transform; use step");
  Mat3 stretch;
  Vec3 translation;
  for (int row = 0; row < 3; ++row) {
    translation[row] = component_at(keys, *at, [&](std::size_t k) { return keys[k].value.translation()[row]; });
    for (int column = 0; column < 3; ++column)
      stretch(row, column) = component_at(keys, *at, [&](std::size_t k) { return factor(k).stretch(row, column); });
  }
  Affine result = Affine::Identity();
  result.linear() =
      rotation_at(keys, *at, [&](std::size_t k) { return factor(k).rotation; }).toRotationMatrix() * stretch;
  result.translation() = translation;
  return result;
}

Camera value_at(const Keyframes<Camera>& keys, double seconds) {
  std::size_t nearest = 0;
  const auto at = segment_at(keys, seconds, nearest);
  if (!at) return keys[nearest].value;
  const Camera &here = keys[at->left].value, &next = keys[at->left + 1].value;
  if (here.orthographic() != next.orthographic()) return here;
  const auto number = [&](const std::function<double(const Camera&)>& of) {
    return component_at(keys, *at, [&](std::size_t k) { return of(keys[k].value); });
  };
  // Logarithms, so that a camera that moves away shrinks the picture evenly.
  const auto scaled = [&](const std::function<double(const Camera&)>& of) {
    if (!(of(here) > 0) || !(of(next) > 0)) return 0.0;
    return std::exp(number([&](const Camera& camera) {
      const double value = of(camera);
      return std::log(value > 0 ? value : of(here));
    }));
  };
  Camera camera = here;
  for (int axis = 0; axis < 3; ++axis)
    camera.target[axis] = number([&](const Camera& one) { return one.target[axis]; });
  const double distance = scaled([](const Camera& one) { return (one.eye - one.target).norm(); });
  const Eigen::Quaterniond rotation = rotation_at(keys, *at, [&](std::size_t k) {
    return Eigen::Quaterniond(Mat3(world_to_camera(keys[k].value).transpose())).normalized();
  });
  camera.eye = camera.target + rotation * Vec3(0, 0, distance);
  // Between cameras with the same up direction, the horizon stays level.
  Vec3 up;
  for (int axis = 0; axis < 3; ++axis) up[axis] = number([&](const Camera& one) { return one.up.normalized()[axis]; });
  camera.up = up.norm() > 0 ? Vec3(up.normalized()) : Vec3(rotation * Vec3::UnitY());
  camera.fov_degrees = number([](const Camera& one) { return one.fov_degrees; });
  camera.ortho_height = scaled([](const Camera& one) { return one.ortho_height; });
  camera.near_plane = scaled([](const Camera& one) { return one.near_plane; });
  camera.far_plane = scaled([](const Camera& one) { return one.far_plane; });
  return camera;
}

}  // namespace rebake
