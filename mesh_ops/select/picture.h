#pragma once

#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A camera and the size of its picture in pixels. Pixel (0, 0) is at the top left.
struct Picture {
  Camera camera;
  int width = 800;
  int height = 800;
};

/// One flag per pixel of a picture, row by row from the top.
struct PixelMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> flags;

  /// False outside the picture.
  bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height &&
           flags[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] != 0;
  }
};

/// Pixels whose centre is inside a closed polygon, by the even-odd rule. Corners in pixels.
PixelMask polygon_mask(const std::vector<Vec2>& corners, int width, int height);
/// Pixels whose centre is at most `radius` pixels from a stroke through `points`.
PixelMask brush_mask(const std::vector<Vec2>& points, double radius, int width, int height);
/// All pixels.
PixelMask full_mask(int width, int height);

/// Projects world points to pixels of a picture.
class Projector {
 public:
  /// Throws FieldError for an invalid camera.
  explicit Projector(const Picture& picture);
  struct At {
    int x, y;
    double depth;  ///< distance along the view axis
  };
  /// Projects a point. Returns false if it is not between the near and far planes. The pixel may lie outside the
  /// picture.
  bool operator()(const Vec3& world, At& at) const;
  /// Ray through a pixel's centre.
  ViewRay ray(int x, int y) const;
  /// Where the line of sight to a world point begins: on the camera's near plane.
  Vec3 start_for(const Vec3& world) const;
  const Camera& camera() const { return picture_.camera; }

 private:
  Picture picture_;
  Vec3 eye_;
  Mat3 rows_;
  double half_height_;  ///< half the visible height in world units; for a pinhole, at depth 1
};

/// Triangles whose centroid projects to a flagged pixel at a depth in [nearest, farthest], including occluded ones.
TriangleSet projected_triangles(const BakedObject& object, const Affine& to_world, const Projector& project,
                                const PixelMask& mask, double nearest, double farthest);

/// Per object: the triangles visible through the centre of a flagged pixel at a depth in [nearest, farthest]. The
/// objects occlude each other. A triangle that covers no pixel centre is not found.
std::vector<TriangleSet> visible_triangles(const std::vector<PlacedNode>& objects, const Projector& project,
                                           const PixelMask& mask, double nearest, double farthest);

/// Viewpoint in object space: a point, or a direction for parallel rays (a viewpoint at infinity).
struct Viewpoint {
  Vec3 eye{0, 0, 0};   ///< ignored for parallel rays
  Vec3 back{0, 0, 0};  ///< unit vector towards the viewer for parallel rays; zero for a point
};

/// A camera's viewpoint in object space. `to_object`: transform from world to object space.
Viewpoint viewpoint_of(const Camera& camera, const Affine& to_object);

/// Triangles without an opaque texel visible from any of the viewpoints. Tests up to 16 texels per triangle: one that
/// is visible only through a gap smaller than their spacing counts as unseen.
TriangleSet triangles_unseen(const BakedObject& object, const std::vector<Viewpoint>& viewpoints);

/// `count` viewpoints spread evenly on a sphere around a box; its radius is `distance` times the box's half diagonal.
std::vector<Viewpoint> viewpoints_around(const Box& box, int count, double distance);

}  // namespace rebake
