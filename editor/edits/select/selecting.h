#pragma once

#include <functional>

#include "editor/edits/support.h"
#include "mesh_ops/index/components.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// The objects that a selection works on: those of a node and the nodes inside it, or, with none named, of every node
/// that is visible and not locked. Throws EditError when the named node is locked or holds no object, and when there is
/// nothing to select from.
std::vector<PlacedNode> selectable(const Scene& scene, const std::optional<NodeRef>& node);

/// All visible objects: what hides what in a picture.
std::vector<PlacedNode> visible_objects(const Scene& scene);

/// The scene with `found(placed)` joined to each target's selection.
Scene with_selected(const Scene& scene, const std::vector<PlacedNode>& targets, SelectMode mode,
                    const std::function<TriangleSet(const PlacedNode&)>& found);

/// The present selection of a node, empty where nothing is selected.
TriangleSet selection_of(const PlacedNode& placed);

/// The number of the triangle that is nearest to a world point, and whose it is; with `opaque` among those that
/// show an opaque texel. Throws EditError when there is none.
struct NearestTriangle {
  std::size_t target;
  std::size_t triangle;
};
NearestTriangle nearest_triangle(const std::vector<PlacedNode>& targets, const Vec3& world, bool opaque);

/// The field by which corners are welded, for edits that ask what lies beside what.
struct WeldingField {
  double tolerance = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tolerance", self.tolerance, Need::optional,
          "corners at most this far apart count as one; 0: only equal ones", Unit::object_length);
  }
  /// Throws FieldError.
  void check() const;
};

/// Fields that say when triangles hang together.
struct JoiningFields {
  WeldingField welding;
  double gap = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    WeldingField::fields(self.welding, visit);
    visit(
        "gap", self.gap, Need::optional,
        "opaque texels at most this far apart are connected too; they are sampled up to a quarter of it apart, so only "
        "connections of up to 0.6 of it are sure to be found",
        Unit::object_length);
  }
  /// Throws FieldError.
  Joining checked() const;
};

/// The selection of each target changed `steps` times by `change`, which is given the object's welded corners.
Scene with_selection_stepped(const Scene& scene, const std::optional<NodeRef>& node, int steps,
                             const WeldingField& welding,
                             TriangleSet (*change)(const WeldedCorners&, const TriangleSet&));

/// Fields of edits that work in a camera's picture.
struct PictureFields {
  std::optional<PixelPolygon> polygon;
  std::optional<BrushStroke> brush;
  std::optional<Interval> depth;
  std::string view;
  std::optional<Camera> camera;
  PixelSize size;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("polygon", self.polygon, Need::optional, "inside a polygon in the picture");
    visit("brush", self.brush, Need::optional, "under a brush stroke in the picture");
    visit("depth", self.depth, Need::optional, "only at these depths along the view axis", Unit::length);
    visit("view", self.view, Need::optional, "name of the stored view whose picture it is");
    visit("camera", self.camera, Need::optional, "the camera whose picture it is");
    visit("size", self.size, Need::optional, "the picture's size, in whose pixels points are given");
  }
};

/// A picture region, ready to be asked. Throws FieldError for fields that contradict each other.
class PictureRegion {
 public:
  PictureRegion(const Scene& scene, const PictureFields& fields);
  const Projector& projector() const { return projector_; }
  const PixelMask& mask() const { return mask_; }
  double nearest() const { return depth_.min; }
  double farthest() const { return depth_.max; }
  /// Whether a world point falls into it, hidden or not.
  bool contains(const Vec3& world) const;
  /// False only where the triangle between world points lies outside altogether.
  bool may_touch(const std::array<Vec3, 3>& world) const;

 private:
  Projector projector_;
  PixelMask mask_;
  Interval depth_;
  Eigen::AlignedBox2i flagged_;  ///< of the mask
};

}  // namespace rebake
