#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "mesh_ops/rays/covered_points.h"
#include "mesh_ops/rays/scene_rays.h"

namespace rebake {

/// What SceneRays::shaded() says of rays from many points that are all parallel: triangles and points are seen along
/// their line, and triangles are asked for the points that they cover, as an irregular shadow map does (Aila and Laine
/// 2004; Johnson et al. 2005). That takes a third to a half of the time of rays one by one where there are about as
/// many points as triangles; where there are few points, or they crowd, rays are sent. Exact like those, to the
/// rounding of floats in an object's frame: rays that pass a border, or start as near to a triangle, by less than 1e-6
/// of the object's size may be told otherwise, and so may depend on what other rays are asked for.
class ParallelRays {
 public:
  /// `around` must outlive it.
  ParallelRays(const SceneRays& around, std::span<const Vec3> origins);
  ~ParallelRays();

  /// Sets hidden[i] to 1 where something opaque lies along the ray from origin first + i: along `direction` (of length
  /// 1) where ways[i] is 1, against it where it is −1. Those of 0, and what is hidden already, are not asked for.
  /// Callable from many threads.
  void shade(const Vec3& direction, std::size_t first, std::span<const std::int8_t> ways,
             std::span<std::uint8_t> hidden) const;

 private:
  struct Triangles {
    std::once_flag made;
    std::vector<std::array<std::vector<float>, 9>> corners;  ///< of each set
    std::vector<bool> solid;
  };
  struct Scratch;

  const Triangles& triangles_of(std::size_t instance) const;
  void shade_by(std::size_t instance, const Vec3& direction, std::size_t first, std::span<const std::int8_t> ways,
                std::span<std::uint8_t> hidden, Scratch& scratch) const;

  const SceneRays& around_;
  std::array<std::vector<double>, 3> points_;  ///< a coordinate after the other
  std::vector<SceneRays::Ball> blocks_;        ///< around so many of them that follow each other
  std::vector<std::size_t> tree_of_;           ///< of an instance, in
  mutable std::vector<std::unique_ptr<Triangles>> trees_;
};

}  // namespace rebake
