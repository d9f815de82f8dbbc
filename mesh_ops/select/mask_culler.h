#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "mesh_ops/rays/ray_tree.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// Culls triangles that no ray through the centre of a mask's flagged pixels can hit. Conservative: keeps triangles if
/// in doubt.
class MaskCuller {
 public:
  /// `project` must outlive this object.
  MaskCuller(const Projector& project, const PixelMask& mask);

  /// Selects the object for the following queries, which are in its space.
  void look_at(const BakedObject& object, const Affine& to_world);
  /// Whether a box lies entirely outside the planes around the rays through flagged pixels.
  bool beside(const Box& box) const;
  /// False only if no ray can hit the triangle abc.
  bool may_hit(const Vec3& a, const Vec3& b, const Vec3& c) const;

 private:
  /// One of four planes around the rays through flagged pixels: points with normal · p ≥ at are inside. Normal 0: no
  /// bound.
  struct Side {
    Vec3 normal{0, 0, 0};
    double at = 0;
  };
  std::size_t corner(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) + static_cast<std::size_t>(x);
  }
  /// Number of flagged pixels above and left of a pixel corner (summed-area table).
  int flagged_before(int x, int y) const { return sums_[corner(x, y)]; }

  const Projector& project_;
  int width_, height_;
  std::vector<int> sums_;
  int left_ = std::numeric_limits<int>::max(), right_ = -1, top_ = left_, bottom_ = -1;
  // Rounding margin in object units, and pixels per object unit at depth 1, for the current object.
  double room_ = 0, pixels_a_unit_ = 0;
  // In object space: the eye; vectors whose dot products with an offset from the eye give pixels right of and below the
  // picture's centre at depth 1; and the same for the depth.
  Vec3 eye_, across_, down_, depth_;
  std::array<Side, 4> sides_;  // planes around all flagged pixels, in object space
};

/// A tree for rays through the mask. It contains only the triangles that may be hit, or all of them if more than an
/// eighth may be. The choice does not depend on cached indices, because at edges rays may find another triangle in
/// another tree.
std::shared_ptr<const RayTree> rays_for_mask(const MaskCuller& mask, const BakedObject& object);

}  // namespace rebake
