#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/rays/ray_tree.h"

namespace rebake {

/// Ray queries in world space through instances of objects; instances share trees. Each object is queried in its own
/// frame: one tree in floats over the whole scene would be too inexact if nodes differ much in scale or lie far apart.
/// A hierarchy of bounding spheres over the instances culls single rays; packets are tested against each instance's
/// sphere.
class SceneRays {
 public:
  struct Instance {
    std::shared_ptr<const RayTree> tree;
    Affine to_world;
    double size;                                             ///< diagonal of the object's box, in object units
    double reach = std::numeric_limits<double>::infinity();  ///< range of shaded(), in world units
  };
  explicit SceneRays(std::vector<Instance> instances);

  struct Hit : RayTree::Hit {
    std::size_t instance;  ///< index of the instance
  };
  /// Nearest opaque triangle with t in [near, far]; of several at the same t, that of the last instance, as in
  /// rendering.
  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double near, double far) const;
  /// Packet of eight coherent rays. Rays with `far` below `near` are skipped. On a hit, `far` is set to its t.
  struct Bundle {
    std::array<Vec3, 8> origins;
    std::array<Vec3, 8> directions;
    std::array<double, 8> far;
    std::array<std::optional<Hit>, 8> hits{};
  };
  void nearest(Bundle& rays, double near) const;
  /// Whether an opaque triangle lies between two points. Triangles at `to` itself, within the trees' error, do not
  /// count.
  bool blocked(const Vec3& from, const Vec3& to) const;
  /// Whether an opaque triangle lies along the unit vector `direction`, within its instance's `reach`.
  bool shaded(const Vec3& from, const Vec3& direction) const;

 private:
  friend class ParallelRays;
  /// Bounding sphere in world space.
  struct BoundingSphere {
    Vec3 middle{0, 0, 0};
    double radius = 0;

    /// Whether a ray misses the sphere. Conservative: false within rounding.
    bool missed_by(const Vec3& origin, const Vec3& direction) const;
  };
  /// An instance with its bounding sphere.
  struct Placed {
    std::shared_ptr<const RayTree> tree;
    Affine to_object;
    double size, reach;
    BoundingSphere ball;
  };
  /// Node of the sphere hierarchy, over order_[first] … order_[end − 1]. Its children are the next branch and branch
  /// `second`.
  struct Branch {
    BoundingSphere ball;
    std::uint32_t first, end;
    std::uint32_t second;  ///< 0 for a leaf
  };

  /// Builds the hierarchy over order_[first] … order_[end − 1], and sorts them.
  void grow(std::uint32_t first, std::uint32_t end);
  /// Calls visit(instance) for instances whose spheres the ray meets, in any order, until it returns true. Returns
  /// whether it did.
  template <class Visit>
  bool any_near(const Vec3& origin, const Vec3& direction, Visit visit) const;

  std::vector<Placed> placed_;
  std::vector<std::uint32_t> order_;  ///< instance indices, in the order of the hierarchy's leaves
  std::vector<Branch> branches_;
};

}  // namespace rebake
