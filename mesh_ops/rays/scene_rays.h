#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/rays/ray_tree.h"

namespace rebake {

/// Rays in world space through placed objects, whose trees are shared by all nodes and scenes that show them. Each
/// object keeps a frame of its own, in which floats tell its triangles apart: one tree over all of them would not,
/// where nodes differ much in scale or lie far apart. What a ray does not come near costs tests against a few balls, in
/// a tree over the objects; bundles are tested against each object's.
class SceneRays {
 public:
  struct Instance {
    std::shared_ptr<const RayTree> tree;
    Affine to_world;
    double size;  ///< of the object, the diagonal of its box in its own units
    double reach = std::numeric_limits<double>::infinity();  ///< in world units: farther away it shades nothing
  };
  explicit SceneRays(std::vector<Instance> instances);

  struct Hit {
    double t;                ///< at origin + t · direction
    std::size_t instance;    ///< number of the instance
    std::uint32_t triangle;  ///< in the object's numbering
  };
  /// The nearest opaque triangle with t in [near, far]; of several at one t the last instance's, as pictures show.
  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double near, double far) const;
  /// The same for eight rays that go much the same way. Those whose `far` is below `near` are left out. Where something
  /// is hit, `far` becomes its t.
  struct Bundle {
    std::array<Vec3, 8> origins;
    std::array<Vec3, 8> directions;
    std::array<double, 8> far;
    std::array<std::optional<Hit>, 8> hits{};
  };
  void nearest(Bundle& rays, double near) const;
  /// Whether anything opaque lies between two points; not at `to` itself, within the trees' rounding.
  bool blocked(const Vec3& from, const Vec3& to) const;
  /// Whether anything opaque lies along the direction of length 1, within the instances' reach.
  bool shaded(const Vec3& from, const Vec3& direction) const;

 private:
  friend class ParallelRays;
  struct Ball {
    Vec3 middle{0, 0, 0};  ///< in world space
    double radius = 0;

    /// Whether what begins at `origin` goes past it.
    bool passed_by(const Vec3& origin, const Vec3& direction) const;
  };
  struct Placed {
    std::shared_ptr<const RayTree> tree;
    Affine to_object;
    double size, reach;
    Ball ball;
  };
  /// A ball around instances `first` … `end` − 1 of `order_`, whose halves follow: the next branch and `second`.
  struct Branch {
    Ball ball;
    std::uint32_t first, end;
    std::uint32_t second;  ///< 0 where it has no halves
  };

  void grow(std::uint32_t first, std::uint32_t end);
  /// Calls visit(number) for instances whose balls are not passed by, in any order, until it returns true; returns
  /// whether it did.
  template <class Visit>
  bool any_near(const Vec3& origin, const Vec3& direction, Visit visit) const;

  std::vector<Placed> placed_;
  std::vector<std::uint32_t> order_;  ///< the instances, neighbours together
  std::vector<Branch> branches_;
};

}  // namespace rebake
