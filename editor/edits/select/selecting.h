#pragma once

#include <functional>

#include "editor/edits/support.h"
#include "mesh_ops/index/components.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// Objects that a selection works on: visible, unlocked objects at or below `node`, or in the whole scene. A hidden
/// object is included if it is `node` itself. Throws EditError if `node` is locked or there is no such object.
std::vector<PlacedNode> selectable(const Scene& scene, const std::optional<NodeRef>& node);

/// All visible objects, locked or not: the occluders of a picture.
std::vector<PlacedNode> visible_objects(const Scene& scene);

/// The scene with `found(placed)` (a flag per triangle) combined with each target's selection.
Scene with_selected(const Scene& scene, const std::vector<PlacedNode>& targets, SelectMode mode,
                    const std::function<TriangleSet(const PlacedNode&)>& found);

/// The present selection of an object, a flag per triangle; all 0 if nothing is selected.
TriangleSet selection_of(const PlacedNode& placed);

/// A triangle of one of several targets.
struct NearestTriangle {
  std::size_t target;    ///< index of the target
  std::size_t triangle;  ///< number in the target's object
};
/// The triangle nearest to a world point; with `opaque` only triangles that contain an opaque texel count. Throws
/// EditError if there is none.
NearestTriangle nearest_triangle(const std::vector<PlacedNode>& targets, const Vec3& world, bool opaque);

/// Welding tolerance, for edits that need the connectivity of triangles.
struct WeldingField {
  double tolerance = 0;  ///< vertices at most this far apart are welded, in object units; 0: only equal ones

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tolerance", self.tolerance, Need::optional, "vertices at most this far apart are welded; 0: only equal ones",
          Unit::object_length);
  }
  /// Throws FieldError for a negative tolerance.
  void check() const;
};

/// Fields that define when triangles are connected, see Connectivity.
struct ConnectivityFields {
  WeldingField welding;
  double gap = 0;  ///< opaque texels at most this far apart are connected, in object units; 0: only across edges

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    WeldingField::fields(self.welding, visit);
    visit("gap", self.gap, Need::optional,
          "opaque texels at most this far apart are connected too; samples are up to a quarter of it apart, so only "
          "connections up to 0.6 of it are found with certainty",
          Unit::object_length);
  }
  /// Throws FieldError for negative values.
  Connectivity checked() const;
};

/// The scene with `change` (grow or shrink by one ring) applied `steps` times to each object's selection. `change`
/// receives the object's welded vertices and the selection. Throws FieldError for `steps` below 1.
Scene with_repeated_morphology(const Scene& scene, const std::optional<NodeRef>& node, int steps,
                               const WeldingField& welding,
                               TriangleSet (*change)(const WeldedCorners&, const TriangleSet&));

/// Fields of edits that use a region of a camera's picture. Exactly one of `view` and `camera` must be given.
struct PictureFields {
  std::optional<PixelPolygon> polygon;
  std::optional<BrushStroke> brush;
  std::optional<Interval> depth;  ///< range along the view axis, in scene units
  std::string view;               ///< name of a stored view
  std::optional<Camera> camera;
  PixelSize size;  ///< size of the picture in pixels

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("polygon", self.polygon, Need::optional, "inside a polygon in the picture");
    visit("brush", self.brush, Need::optional, "under a brush stroke in the picture");
    visit("depth", self.depth, Need::optional, "range of depths along the view axis", Unit::length);
    visit("view", self.view, Need::optional, "name of the stored view");
    visit("camera", self.camera, Need::optional, "the camera");
    visit("size", self.size, Need::optional, "size of the picture, for pixel coordinates");
  }
};

/// Region of a camera's picture: a polygon, a brush stroke or all pixels, within a depth range. The constructor throws
/// FieldError for contradictory fields.
class PictureRegion {
 public:
  /// Near and far planes that are not given are fitted to the visible objects and `targets`, which may be hidden.
  PictureRegion(const Scene& scene, const PictureFields& fields, const std::vector<PlacedNode>& targets);
  const Projector& projector() const { return projector_; }
  const PixelMask& mask() const { return mask_; }
  double nearest() const { return depth_.min; }
  double farthest() const { return depth_.max; }
  /// Whether a world point projects into the region, occluded or not.
  bool contains(const Vec3& world) const;
  /// False only if the triangle with these world-space corners is entirely outside (conservative test).
  bool may_touch(const std::array<Vec3, 3>& world) const;

 private:
  Projector projector_;
  PixelMask mask_;
  Interval depth_;
  Eigen::AlignedBox2i flagged_;  ///< bounds of the flagged pixels
};

}  // namespace rebake
