#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "mesh_ops/rays/ray_tree.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// Whether a triangle may be met by rays through the centres of a mask's flagged pixels: errs on that side.
class SeenThrough {
 public:
  /// The projector must live on.
  SeenThrough(const Projector& project, const PixelMask& mask);

  /// What is asked from now on is in the object's space.
  void look_at(const BakedObject& object, const Affine& to_world);
  bool beside(const Box& box) const;
  bool may_meet(const Vec3& a, const Vec3& b, const Vec3& c) const;

 private:
  struct Side {
    Vec3 normal{0, 0, 0};
    double at = 0;
  };
  std::size_t corner(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) + static_cast<std::size_t>(x);
  }
  /// Pixels above and left of a corner.
  int flagged_before(int x, int y) const { return sums_[corner(x, y)]; }

  const Projector& project_;
  int width_, height_;
  std::vector<int> sums_;
  int left_ = std::numeric_limits<int>::max(), right_ = -1, top_ = left_, bottom_ = -1;
  // Of the object that is looked at.
  double room_ = 0, pixels_a_unit_ = 0;
  // In its space: pixels from the picture's middle, at a depth of 1, and the depth itself.
  Vec3 eye_, across_, down_, depth_;
  std::array<Side, 4> sides_;  // around all flagged pixels, in the object's space
};

/// A tree for the rays that `mask` was made for: of the triangles that may be met alone, which takes less than one of
/// all, or of all where many may be met. Which it is does not depend on what is indexed already: at edges, rays may
/// find another triangle in another tree.
std::shared_ptr<const RayTree> rays_seen_through(const SeenThrough& mask, const BakedObject& object);

}  // namespace rebake
