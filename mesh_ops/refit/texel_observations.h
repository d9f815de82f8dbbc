#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/refit/photograph_fit.h"

namespace rebake {

/// A texel with a place on the surface.
struct ObservedTexel {
  std::uint32_t set = 0, x = 0, y = 0;
  Vec3 position, normal;  ///< object space; the normal is not unit
  Mat3 to_fed;            ///< from directions in object space to the decoder's
  bool chosen = false;    ///< lies in a triangle whose texels change
};
/// The opaque texels that the triangles of an object show, each with one place. `chosen`: a flag per triangle.
std::vector<ObservedTexel> observed_texels(const BakedObject& object, const TriangleSet& chosen);

/// What a photograph shows of a texel.
struct Observation {
  std::array<float, 3> fed_direction, color;
  float weight = 0;    ///< better views have more; 0: nothing is seen
  bool mixed = false;  ///< some of the pixels also show something else
};

/// A photograph with the depths of the scene at its pixels.
class ObservingPhotograph {
 public:
  /// `photograph` and `occluders` must outlive this object.
  /// `largest_pixel`: pixels that cover more of a surface, in world units, show nothing of it.
  ObservingPhotograph(const FitPhotograph& photograph, const SceneRays& occluders, double scene_size,
                      double largest_pixel);
  /// What the photograph shows of a texel of a node; weight 0 if it does not show it.
  Observation observe(const ObservedTexel& texel, const Affine& to_world, const Mat3& world_to_object_turn) const;

 private:
  const FitPhotograph& photograph_;
  const SceneRays& occluders_;
  Mat3 to_camera_;
  double largest_pixel_;
  double focal_;               // pixels
  std::vector<float> depths_;  // along the view axis; infinite for background
};

}  // namespace rebake
