#pragma once

#include <memory>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Samples of keyframes for formats that interpolate in their own way.
struct PlaceSamples {
  bool step = false;  ///< values jump; otherwise numbers are linear and rotations spherically linear between samples
  std::vector<double> seconds;
  std::vector<Vec3> translations, scales;
  std::vector<Eigen::Quaterniond> rotations;
  bool sheared = false;  ///< a place has a shear, which is left out
};
/// Linear and stepped keyframes are their own samples; otherwise 30 samples per second, fewer in motions of more than
/// 11 minutes, and the keyframes.
PlaceSamples place_samples(const Keyframes<Affine>& keys);
/// Translation and rotation of a camera that looks along −z; scales are 1.
PlaceSamples camera_samples(const Keyframes<Camera>& keys);

/// Poses of a node's bends, for linear interpolation of positions between times.
struct BendPoses {
  std::shared_ptr<const BakedObject> rest;  ///< the unbent object; corners are split as in the poses
  std::vector<double> seconds;
  std::vector<std::shared_ptr<const BakedObject>> poses;  ///< with the faces and UVs of `rest`
  double deviation =
      0;  ///< largest distance of a vertex from its exact place, at three times between poses, in object units
};
/// Poses at the keyframes of all bends, and at times between them until the deviation is at most 1/500 of the object's
/// diagonal and 1/50 of the farthest way of a vertex, or there are 32 poses.
BendPoses bend_poses(const Node& node);

}  // namespace rebake
