#pragma once

#include <filesystem>

#include "mesh_ops/base/types.h"

namespace rebake::test {

/// A generated nerf2mesh folder in the published layout: a sphere of shared charts around the origin, z up, per mesh.
struct Nerf2MeshExample {
  int meshes = 1;     ///< radius 1, 2, …
  int hidden = 32;    ///< width of the network
  bool jpeg = false;  ///< format of the images; otherwise PNG
  int side = 64;      ///< of the images
  unsigned seed = 1;
};

/// What the files of an example hold.
struct Nerf2MeshNumbers {
  Eigen::MatrixXd first;   ///< net.0.weight, 6 × h: direction, specular features
  Eigen::MatrixXd second;  ///< net.1.weight, h × 3
  /// The colour by nerf2mesh's formula; `diffuse` and `specular` in 0 … 1, `direction` from the camera to the point.
  Vec3 color(const Vec3& diffuse, const Vec3& specular, const Vec3& direction) const;
};

Nerf2MeshNumbers write_nerf2mesh_example(const std::filesystem::path& folder, const Nerf2MeshExample& example = {});

}  // namespace rebake::test
