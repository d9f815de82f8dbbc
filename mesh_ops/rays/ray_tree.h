#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Bounding volume hierarchy (Embree) over the triangles of an object, without texels. It is the expensive part of a
/// RayTree, and stays valid if texels change. Copies the positions.
class RayTriangles {
 public:
  explicit RayTriangles(const BakedObject& object);
  /// Only the triangles with the numbers `only`, in ascending order. Rays find the same hits as among all triangles,
  /// except hits of the omitted ones, and hits at edges within float rounding.
  RayTriangles(const BakedObject& object, const std::vector<std::uint32_t>& only);
  RayTriangles(RayTriangles&&) noexcept;
  ~RayTriangles();
  std::uint64_t memory() const;  ///< bytes

 private:
  friend class RayTree;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Ray queries for the opaque surface of an object; rays pass through transparent texels. Distances have single
/// precision relative to the object's centre: an error of about 1e-6 of its size. The object's arrays must outlive this
/// tree.
class RayTree {
 public:
  explicit RayTree(const BakedObject& object);
  /// `triangles`: all or some triangles of an object with the same positions and faces.
  RayTree(std::shared_ptr<const RayTriangles> triangles, const BakedObject& object);
  RayTree(RayTree&&) noexcept;
  ~RayTree();

  struct Hit {
    double t;                ///< the hit is at origin + t · direction
    std::uint32_t triangle;  ///< in the object's numbering
  };
  /// Nearest opaque hit with t in [near, far]. Origin and direction in object space; the direction may have any length.
  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double near, double far) const;
  /// Packet of eight coherent rays, faster than single rays. Rays with `far` below `near` are skipped. On a hit, `far`
  /// and `triangle` are set to those of the hit.
  struct Bundle {
    std::array<Vec3, 8> origins;
    std::array<Vec3, 8> directions;
    std::array<double, 8> far;
    std::array<std::uint32_t, 8> triangle;
    std::array<bool, 8> hit;
  };
  void nearest(Bundle& rays, double near) const;
  /// Whether an opaque triangle lies at t in [near, far].
  bool blocked(const Vec3& origin, const Vec3& direction, double near, double far) const;
  /// Bounding box of the triangles in object space, slightly enlarged.
  Box bounds() const;

  /// Transform from object space to the tree's frame, where the longest side of the box is ½ … 1. This and the next
  /// functions serve ParallelRays, which tests triangles without the tree.
  Affine to_frame() const;
  std::size_t triangle_count() const;
  /// Corners in the tree's frame, as [set][3 · corner + axis][triangle], padded with `room` NaNs. Coordinates that are
  /// not finite become NaN.
  std::vector<std::array<std::vector<float>, 9>> corners(std::size_t room) const;
  /// Whether all texels of a set's texture are opaque.
  bool solid(std::size_t set) const;
  /// Opacity at a point of a triangle, numbered as in corners(); b1 and b2 are the weights of its second and third
  /// corner.
  bool opaque(std::size_t set, std::uint32_t triangle, double b1, double b2) const;
  std::uint64_t memory() const;  ///< bytes, without the triangles

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
