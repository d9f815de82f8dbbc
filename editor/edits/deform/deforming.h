#pragma once

#include "editor/edits/support.h"
#include "editor/fields/codec.h"
#include "mesh_ops/deform/cage.h"
#include "mesh_ops/deform/deform_object.h"
#include "mesh_ops/deform/wrap.h"

namespace rebake {

/// Fields that say which triangles a deformation takes.
struct DeformTarget {
  std::optional<NodeRef> node;
  bool selection = false;
  std::optional<BoxRegion> box;
  CoordinateFrame frame = CoordinateFrame::world;
  double falloff = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "with those inside it; left out: all that have selected triangles");
    visit("selection", self.selection, Need::optional, "only its selected triangles");
    visit("box", self.box, Need::optional, "only triangles whose centre lies inside");
    visit("frame", self.frame, Need::optional,
          "of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1");
    visit("falloff", self.falloff, Need::optional,
          "width of the soft border towards triangles that are not deformed; 0: a hard border", Unit::length);
  }
};

/// Triangles to be deformed: nodes with a flag a triangle.
struct DeformSet {
  std::vector<PlacedNode> nodes;
  std::vector<TriangleSet> flags;

  /// World box of their corners.
  Box bounds() const;
  /// In world space, those with an opaque texel only.
  TriangleList opaque_triangles() const;
  /// Least and greatest x · axis over their corners.
  std::pair<double, double> extent_along(const Vec3& axis) const;
};

/// Throws EditError when nothing is left to deform, FieldError for a bad field.
DeformSet deform_set(const Scene& scene, const DeformTarget& target);

/// The scene with them deformed, and what that did to each. Throws EditError when what shows something would stay
/// behind because the deformation does not reach it. `notes` are said of each object.
Outcome with_deformed(const Scene& scene, const DeformSet& set, double falloff, const SpaceDeformation& deformation,
                      const std::vector<std::string>& notes = {});

/// Some points of a cage, and how they move.
struct CageMove {
  NumberRanges points;
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  bool nearest = false;
  Vec3 translate{0, 0, 0};
  Rotation rotate;
  Scale scale;
  std::optional<Vec3> pivot;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("points", self.points, Need::optional, "numbers of cage points");
    visit("box", self.box, Need::optional, "cage points inside a box");
    visit("sphere", self.sphere, Need::optional, "cage points inside a sphere");
    visit("nearest", self.nearest, Need::optional,
          "where no point lies inside the sphere: the one nearest to its centre");
    visit("translate", self.translate, Need::optional, "how far the points move", Unit::length);
    visit("rotate", self.rotate, Need::optional, "rotation");
    visit("scale", self.scale, Need::optional, "factor");
    visit("pivot", self.pivot, Need::optional, "what scale and rotation keep; left out: the points' centre");
  }
};
using CageMoves = std::vector<CageMove>;

template <>
struct Codec<CageMoves> {
  static FieldType type();
  static CageMoves read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(const CageMoves& value);
};

/// The cage points that a move takes. Regions are in world units, or with `shares` in shares of the cage's box. Throws
/// FieldError when it names a point that is not there, or takes none.
std::vector<std::uint32_t> points_of(const CageMove& move, const Cage& cage, bool shares);

/// Where the cage's points are after all moves, in their order; each starts from where the one before left them.
std::vector<Vec3> moved_points(const CageMoves& moves, const Cage& cage, bool shares);

/// How a cage is made: exactly one way.
struct CageSource {
  std::vector<int> lattice;
  std::optional<double> wrap;
  Cage mesh;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("lattice", self.lattice, Need::optional, "a box around the triangles, of so many cells along x, y and z");
    visit("wrap", self.wrap, Need::optional,
          "a wrap of the triangles that show something; its coarseness of their size, 0.005 to 0.5", Unit::share);
    visit("mesh", self.mesh, Need::optional,
          "a closed triangle mesh in world space: a file (.obj, .off, .ply), or its vertices and faces");
  }
};

template <>
struct Codec<Cage> {
  static FieldType type();
  static Cage read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(const Cage& value);
};
/// What people should know of a cage that is about to move: places where it cuts through itself, before or after.
std::vector<std::string> notes_on(const Cage& cage, const std::vector<Vec3>& moved);

/// The cage around what is deformed, in world space. With no way given, a wrap of coarseness 0.1.
Cage cage_of(const CageSource& source, const DeformSet& set, const Progress& progress = {});

}  // namespace rebake
