#pragma once

#include "editor/edits/support.h"
#include "editor/fields/codec.h"
#include "mesh_ops/deform/cages/cage_mesh.h"
#include "mesh_ops/deform/cages/wrap.h"
#include "mesh_ops/deform/deform_object.h"

namespace rebake {

/// Fields that choose the triangles to deform.
struct DeformTarget {
  std::optional<NodeRef> node;                     ///< nothing: all objects with selected triangles
  bool selection = false;                          ///< only selected triangles of `node`
  std::optional<BoxRegion> box;                    ///< only triangles whose centre is inside
  CoordinateFrame frame = CoordinateFrame::world;  ///< coordinates of `box`; if bounds, also of cage moves
  double falloff = 0;                              ///< width of the soft border, in scene units; 0: hard

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "node to deform, with its children; default: all with selected triangles");
    visit("selection", self.selection, Need::optional, "only selected triangles");
    visit("box", self.box, Need::optional, "only triangles whose centre is inside");
    visit("frame", self.frame, Need::optional,
          "coordinates of the box: world; node: object space; bounds: relative to the object's box, 0 to 1");
    visit("falloff", self.falloff, Need::optional, "width of the soft border towards undeformed triangles; 0: hard",
          Unit::length);
  }
};

/// Triangles to deform: objects with a flag per triangle.
struct DeformSet {
  std::vector<PlacedNode> nodes;
  std::vector<TriangleSet> flags;  ///< per node: a flag per triangle

  /// World box of the flagged triangles.
  Box bounds() const;
  /// The flagged triangles with an opaque texel, in world space.
  TriangleList opaque_triangles() const;
  /// Minimum and maximum of x · axis over the corners x of the flagged triangles, in world space.
  std::pair<double, double> extent_along(const Vec3& axis) const;
};

/// The triangles of a target. Throws EditError if there is none, FieldError for a negative falloff.
DeformSet deform_set(const Scene& scene, const DeformTarget& target);

/// The scene with the triangles deformed, and a report line per object. `notes` are appended to each line. Throws
/// EditError if opaque triangles lie outside the domain of the deformation, and if a result is too large for float.
Outcome with_deformed(const Scene& scene, const DeformSet& set, double falloff, const SpaceDeformation& deformation,
                      const std::vector<std::string>& notes = {});

/// A rotation, scale and translation of some cage vertices: of those with given numbers, in a box or in a sphere.
/// Exactly one of these must be given.
struct CageMove {
  NumberRanges points;  ///< vertex numbers, from 0
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  bool nearest = false;  ///< if no vertex is in the sphere: take the one nearest to its centre
  Vec3 translate{0, 0, 0};
  Rotation rotate;
  Scale scale;
  std::optional<Vec3> pivot;  ///< fixed point of rotation and scale; nothing: centre of the vertices' box

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("points", self.points, Need::optional, "numbers of cage vertices");
    visit("box", self.box, Need::optional, "cage vertices inside a box");
    visit("sphere", self.sphere, Need::optional, "cage vertices inside a sphere");
    visit("nearest", self.nearest, Need::optional,
          "if the sphere contains no vertex: use the one nearest to its centre");
    visit("translate", self.translate, Need::optional, "translation of the vertices", Unit::length);
    visit("rotate", self.rotate, Need::optional, "rotation");
    visit("scale", self.scale, Need::optional, "factor");
    visit("pivot", self.pivot, Need::optional, "fixed point of rotation and scale; default: the vertices' centre");
  }
};
using CageMoves = std::vector<CageMove>;

template <>
struct Codec<CageMoves> {
  static FieldType type();
  static CageMoves read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(const CageMoves& value);
};

/// Numbers of the cage vertices that a move affects. Regions are in world units, or with `shares` relative to the
/// cage's box (0 … 1). Throws FieldError for a vertex number out of range and if there is no vertex.
std::vector<std::uint32_t> points_of(const CageMove& move, const Cage& cage, bool shares);

/// World distance of a cage vertex from the centre of the move's sphere. `box`: of the cage's surface.
double distance_from_center(const CageMove& move, const Box& box, bool shares, const Vec3& vertex);

/// Positions of all cage vertices after the moves, applied one after another. Each move chooses its vertices by their
/// original positions. Throws FieldError for non-finite results.
std::vector<Vec3> moved_points(const CageMoves& moves, const Cage& cage, bool shares);

/// Source of a cage: at most one of lattice, wrap and mesh; by default a wrap of coarseness 0.1.
struct CageSource {
  std::vector<int> lattice;    ///< box with this number of cells along x, y and z
  std::optional<double> wrap;  ///< coarseness of an alpha wrap of the opaque triangles, see wrap()
  Cage mesh;                   ///< closed mesh in world space

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("lattice", self.lattice, Need::optional, "a box around the triangles; number of cells along x, y and z");
    visit("wrap", self.wrap, Need::optional,
          "a wrap of the opaque triangles; coarseness relative to their size, 0.005 to 0.5", Unit::share);
    visit("mesh", self.mesh, Need::optional,
          "a closed triangle mesh in world space: a file (.obj, .off, .ply), or vertices and faces");
  }
};

template <>
struct Codec<Cage> {
  static FieldType type();
  static Cage read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(const Cage& value);
};
/// Warnings for users if a cage intersects itself, before or after its vertices move to `moved`.
std::vector<std::string> cage_warnings(const Cage& cage, const std::vector<Vec3>& moved);

/// The cage around the triangles, in world space. Throws FieldError for contradictory fields, EditError if there is no
/// opaque triangle to wrap.
Cage cage_of(const CageSource& source, const DeformSet& set, const Progress& progress = {});

}  // namespace rebake
