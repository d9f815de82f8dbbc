#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"
#include "mesh_ops/scene/camera.h"

namespace rebake {

/// How a value moves from its keyframe to the next one. smooth: with continuous velocity, at rest at the first and last
/// keyframe and at turning points, without overshoot.
enum class Interpolation { smooth, linear, step };

/// Latest time of a keyframe in seconds: a day.
inline constexpr double most_seconds = 86400;

/// A value at a time.
template <class Value>
struct Keyframe {
  double seconds = 0;
  Value value;
  Interpolation to_next = Interpolation::smooth;

  friend bool operator==(const Keyframe& a, const Keyframe& b) {
    if constexpr (std::is_same_v<Value, Affine>)
      return a.seconds == b.seconds && a.to_next == b.to_next && a.value.matrix() == b.value.matrix();
    else
      return a.seconds == b.seconds && a.to_next == b.to_next && a.value == b.value;
  }
};

/// Keyframes in the order of their times, which differ.
template <class Value>
using Keyframes = std::vector<Keyframe<Value>>;

/// Adds a keyframe, in place of one at the same time.
template <class Value>
void set_key(Keyframes<Value>& keys, Keyframe<Value> key) {
  const auto at = std::lower_bound(keys.begin(), keys.end(), key.seconds,
                                   [](const Keyframe<Value>& one, double seconds) { return one.seconds < seconds; });
  if (at != keys.end() && at->seconds == key.seconds)
    *at = std::move(key);
  else
    keys.insert(at, std::move(key));
}

/// Removes the keyframe at a time; returns whether there was one.
template <class Value>
bool remove_key(Keyframes<Value>& keys, double seconds) {
  return std::erase_if(keys, [&](const Keyframe<Value>& key) { return key.seconds == seconds; }) > 0;
}

/// A bend whose angle has keyframes. Its fields mean the same as those of ClosedForm, in the space of `to_space`.
struct BendTrack {
  std::string selection;                 ///< name of a stored selection of the node; empty: all its triangles
  std::optional<Box> box;                ///< only triangles whose centre, mapped by `to_box`, is inside
  Affine to_box = Affine::Identity();    ///< from object space
  Affine to_space = Affine::Identity();  ///< from object space to the space of the fields below
  double falloff = 0;                    ///< width of the soft border; 0: hard
  Vec3 origin{0, 0, 0}, axis{0, 1, 0}, direction{1, 0, 0};
  double from = 0, to = 1;
  std::vector<Vec3> spine;  ///< curved axis, or empty
  Keyframes<double> degrees;
};
bool operator==(const BendTrack& a, const BendTrack& b);

/// Keyframes of a node. Its own transform and triangles are those outside of films.
struct NodeMotion {
  Keyframes<Affine> place;                 ///< transform to the parent
  std::map<std::string, BendTrack> bends;  ///< by name, applied in this order

  bool empty() const { return place.empty() && bends.empty(); }
  bool operator==(const NodeMotion&) const = default;
};

/// The value at a time; before the first keyframe that of the first, after the last that of the last. At the time of a
/// keyframe its very value. `keys` must not be empty.
///
/// Numbers: piecewise cubic with the slopes of Fritsch and Butland (1984), monotone between keyframes.
double value_at(const Keyframes<double>& keys, double seconds);
/// Translation and stretch by components; the rotation of the polar factors along the shortest way, smooth ones as a
/// spherical Bézier curve (Shoemake 1985). Throws Error if one of two transforms is mirrored, or one is singular.
Affine value_at(const Keyframes<Affine>& keys, double seconds);
/// The target, the logarithm of the distance and the up direction by components, and the direction to the eye by the
/// rotation as above, so that the camera stays on an orbit about a fixed target. Between a pinhole and an orthographic
/// camera it jumps at the later keyframe.
Camera value_at(const Keyframes<Camera>& keys, double seconds);

}  // namespace rebake
