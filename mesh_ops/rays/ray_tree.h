#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Where the triangles of an object lie, for rays: what takes long to make, and stays as texels change. Holds copies.
class RayTriangles {
 public:
  explicit RayTriangles(const BakedObject& object);
  /// Some of its triangles alone, numbers in ascending order: rays find what they find among all, but for the others,
  /// and where they pass edges by less than the rounding of floats.
  RayTriangles(const BakedObject& object, const std::vector<std::uint32_t>& only);
  RayTriangles(RayTriangles&&) noexcept;
  ~RayTriangles();
  std::uint64_t memory() const;  ///< bytes

 private:
  friend class RayTree;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Finds the opaque triangle that a ray meets first. Transparent texels let rays through. Distances are found in single
/// precision, relative to the object's centre: good to about 1e-6 of its size. The object's arrays must outlive it.
class RayTree {
 public:
  explicit RayTree(const BakedObject& object);
  /// `triangles` are of an object with the same positions and faces, all or some of them.
  RayTree(std::shared_ptr<const RayTriangles> triangles, const BakedObject& object);
  RayTree(RayTree&&) noexcept;
  ~RayTree();

  struct Hit {
    double t;                ///< at origin + t · direction
    std::uint32_t triangle;  ///< in the object's numbering
  };
  /// The nearest hit with t in [near, far]. Origin and direction in object space, the direction of any length.
  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double near, double far) const;
  /// The same for eight rays that go much the same way: faster than one by one. Rays whose `far` is below
  /// `near` are left out. Where something is hit, `far` and `triangle` become the hit's.
  struct Bundle {
    std::array<Vec3, 8> origins;
    std::array<Vec3, 8> directions;
    std::array<double, 8> far;
    std::array<std::uint32_t, 8> triangle;
    std::array<bool, 8> hit;
  };
  void nearest(Bundle& rays, double near) const;
  /// Whether anything opaque lies at t in [near, far].
  bool blocked(const Vec3& origin, const Vec3& direction, double near, double far) const;
  /// Of the triangles, in object space, with some room.
  Box bounds() const;

  /// What ParallelRays asks instead of the tree, in the tree's own frame: there the box is about 1 wide.
  Affine to_frame() const;
  std::size_t triangle_count() const;
  /// Corners as the tree knows them, in vectors [set][3 · corner + axis], `room` numbers longer that are none.
  std::vector<std::array<std::vector<float>, 9>> corners(std::size_t room) const;
  /// Whether all of a set's texels are opaque.
  bool solid(std::size_t set) const;
  /// Of a triangle in `corners`, at weights of its second and third corner.
  bool opaque(std::size_t set, std::uint32_t triangle, double b1, double b2) const;
  std::uint64_t memory() const;  ///< bytes, without the triangles

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
