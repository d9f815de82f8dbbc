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

/// Occlusion of parallel rays from many points, as SceneRays::shaded() finds it. Projects points and triangles along
/// the rays, and tests each triangle against the points that it covers, like an irregular shadow map (Aila and Laine
/// 2004; Johnson et al. 2005). This is faster than single rays for about as many points as triangles; single rays are
/// used if there are few points, or if they are crowded. Exact up to float rounding in an object's frame: if a ray
/// passes the border of an opaque area, or starts at a triangle, within 1e-6 of the object's size, the result may
/// differ and depend on the other rays of the call.
class ParallelRays {
 public:
  /// `around` must outlive this object. `origins`: in world space.
  ParallelRays(const SceneRays& around, std::span<const Vec3> origins);
  ~ParallelRays();

  /// Sets hidden[i] to 1 if an opaque triangle lies along the ray from origin first + i. The ray goes along the unit
  /// vector `direction` if ways[i] is 1, and against it if −1. Rays with ways[i] = 0, or hidden[i] already 1, are
  /// skipped. Thread-safe.
  void shade(const Vec3& direction, std::size_t first, std::span<const std::int8_t> ways,
             std::span<std::uint8_t> hidden) const;

 private:
  /// Triangles of one tree, extracted on first use.
  struct Triangles {
    std::once_flag made;
    std::vector<std::array<std::vector<float>, 9>> corners;  ///< as of RayTree::corners()
    std::vector<bool> solid;                                 ///< per set: all its texels are opaque
  };
  struct Scratch;

  const Triangles& triangles_of(std::size_t instance) const;
  /// shade() for a single instance.
  void shade_by(std::size_t instance, const Vec3& direction, std::size_t first, std::span<const std::int8_t> ways,
                std::span<std::uint8_t> hidden, Scratch& scratch) const;

  const SceneRays& around_;
  std::array<std::vector<double>, 3> points_;      ///< origins: [axis][point]
  std::vector<SceneRays::BoundingSphere> blocks_;  ///< bounding sphere per block of consecutive origins
  std::vector<std::size_t> tree_of_;               ///< per instance: index in trees_
  mutable std::vector<std::unique_ptr<Triangles>> trees_;
};

}  // namespace rebake
