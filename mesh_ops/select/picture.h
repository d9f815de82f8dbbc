#pragma once

#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A camera's picture. Pixel (0, 0) is at the top left.
struct Picture {
  Camera camera;
  int width = 800;
  int height = 800;
};

/// A flag for each pixel of a picture, row by row from the top.
struct PixelMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> flags;

  bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height &&
           flags[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] != 0;
  }
};

/// Pixels whose centre is inside a closed polygon, by the even-odd rule. Corners in pixels.
PixelMask polygon_mask(const std::vector<Vec2>& corners, int width, int height);
/// Pixels whose centre is at most `radius` pixels from a stroke through `points`.
PixelMask brush_mask(const std::vector<Vec2>& points, double radius, int width, int height);
PixelMask full_mask(int width, int height);

/// Where world points fall in a picture.
class Projector {
 public:
  /// Throws FieldError for a camera that is not sound.
  explicit Projector(const Picture& picture);
  struct At {
    int x, y;
    double depth;  ///< along the view axis
  };
  /// False behind the near plane or beyond the far one. Pixels outside the picture are possible.
  bool operator()(const Vec3& world, At& at) const;
  /// Through a pixel's centre.
  ViewRay ray(int x, int y) const;
  /// From where a world point is looked at.
  Vec3 eye_for(const Vec3& world) const;
  const Camera& camera() const { return picture_.camera; }

 private:
  Picture picture_;
  Vec3 eye_;
  Mat3 rows_;
  double half_height_;  ///< of the picture in the world; of a pinhole's at a depth of 1
};

/// Triangles whose centre falls on a flagged pixel at a depth in [nearest, farthest], hidden ones too.
TriangleSet triangles_under(const BakedObject& object, const Affine& to_world, const Projector& project,
                            const PixelMask& mask, double nearest, double farthest);

/// For each of `objects` the triangles that are seen through the centre of a flagged pixel, at a depth in [nearest,
/// farthest]; the objects hide each other. A triangle that covers no pixel's centre is not seen.
std::vector<TriangleSet> triangles_seen(const std::vector<PlacedNode>& objects, const Projector& project,
                                        const PixelMask& mask, double nearest, double farthest);

/// From where an object is looked at, in its space: from a point, or from as good as nowhere by parallel rays.
struct Standpoint {
  Vec3 eye{0, 0, 0};
  Vec3 back{0, 0, 0};  ///< of parallel rays the way to where they come from, of length 1; else 0
};

/// A camera's, in the space that `to_object` leads to from the world.
Standpoint standpoint_of(const Camera& camera, const Affine& to_object);

/// Triangles of which no opaque part (up to 16 texels of each are tried) is seen from any of the standpoints.
/// Errs on the side of seen only as far as those texels reach: a triangle seen through a gap smaller than their spacing
/// counts as unseen.
TriangleSet triangles_unseen(const BakedObject& object, const std::vector<Standpoint>& standpoints);

/// `count` points spread evenly on a sphere around a box, at `distance` times its half diagonal from its centre.
std::vector<Standpoint> eyes_around(const Box& box, int count, double distance);

}  // namespace rebake
