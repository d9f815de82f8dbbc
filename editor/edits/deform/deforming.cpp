#include "editor/edits/deform/deforming.h"

#include "editor/fields/visitors.h"

#include <fmt/format.h>

#include <limits>

#include "editor/edits/select/selecting.h"
#include "editor/edits/shared_result_cache.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/formats/cage_file.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/opacity.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

namespace {

// Calls visit(world position) for each finite corner of the flagged triangles.
template <class Visit>
void for_corners(const PlacedNode& placed, const TriangleSet& flags, Visit visit) {
  std::size_t f = 0;
  for (const TextureSet& set : placed.node->object->sets)
    for (const Face& face : set.soup.faces())
      if (flags[f++] != 0)
        for (const std::uint32_t vertex : face)
          if (const Vec3 p = placed.to_world * set.soup.positions()[vertex]; p.allFinite()) visit(p);
}

}  // namespace

Box DeformSet::bounds() const {
  Box box;
  for (std::size_t k = 0; k < nodes.size(); ++k) for_corners(nodes[k], flags[k], [&](const Vec3& p) { box.extend(p); });
  return box;
}

std::pair<double, double> DeformSet::extent_along(const Vec3& axis) const {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for_corners(nodes[k], flags[k], [&](const Vec3& p) {
      low = std::min(low, p.dot(axis));
      high = std::max(high, p.dot(axis));
    });
  return {low, high};
}

TriangleList DeformSet::opaque_triangles() const {
  TriangleList list;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const BakedObject& object = *nodes[k].node->object;
    std::size_t f = 0;
    for (const TextureSet& set : object.sets) {
      // Includes each triangle that may show an opaque texel when drawn.
      const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
      std::size_t in_set = 0;
      const auto base = static_cast<std::uint32_t>(list.points.size());
      for (const Vec3& p : set.soup.positions()) list.points.push_back(nodes[k].to_world * p);
      for (const Face& face : set.soup.faces()) {
        if (shows[in_set++] != 0 && flags[k][f] != 0)
          list.faces.push_back({face[0] + base, face[1] + base, face[2] + base});
        ++f;
      }
    }
  }
  return list;
}

DeformSet deform_set(const Scene& scene, const DeformTarget& target) {
  if (!(target.falloff >= 0)) throw FieldError("falloff", "must not be negative");
  DeformSet set;
  const bool selected = target.selection || !target.node;
  for (PlacedNode& placed : selected ? objects_with_selection(scene, target.node) : selectable(scene, target.node)) {
    TriangleSet flags =
        selected ? *placed.node->selection : TriangleSet(placed.node->object->triangle_count(), std::uint8_t{1});
    if (target.box) {
      const TriangleSet inside = triangles_by_centre(
          *placed.node->object, region_of(FrameTransform(target.frame, placed), *target.box).inside);
      for (std::size_t f = 0; f < flags.size(); ++f) flags[f] &= inside[f];
    }
    if (count(flags) == 0) continue;
    set.nodes.push_back(std::move(placed));
    set.flags.push_back(std::move(flags));
  }
  if (set.nodes.empty()) throw EditError("no triangle has its centre inside the box, so there is nothing to deform");
  return set;
}

namespace {

std::string in_words(const std::string& name, const DeformationReport& report) {
  std::string line =
      fmt::format("{} of \"{}\" deformed, minimum det J {:.3g}",
                  counted(report.changed, "welded vertex", "welded vertices"), name, report.min_determinant);
  if (report.folded > 0)
    line += fmt::format("; {} folded or collapsed (det J ≤ 0): select_folded selects the triangles",
                        counted(report.folded, "is", "are"));
  if (report.undefined > 0)
    line += fmt::format("; {} no unique rotation and {} that of a neighbour", counted(report.undefined, "has", "have"),
                        report.undefined == 1 ? "takes" : "take");
  if (report.outside > 0)
    line += fmt::format("; {} outside the cage and {}",
                        counted(report.outside, "transparent one is", "transparent ones are"),
                        report.outside == 1 ? "stays" : "stay");
  if (report.not_finite > 0)
    line += fmt::format("; {} not finite, or would not be, and {}", counted(report.not_finite, "is", "are"),
                        report.not_finite == 1 ? "stays" : "stay");
  return line;
}

}  // namespace

Outcome with_deformed(const Scene& scene, const DeformSet& set, double falloff, const SpaceDeformation& deformation,
                      const std::vector<std::string>& notes) {
  Scene result = scene;
  Report report;
  for (std::size_t k = 0; k < set.nodes.size(); ++k) {
    DeformedObject made =
        deformed(*set.nodes[k].node->object, set.nodes[k].to_world, set.flags[k], falloff, deformation);
    const bool changed = made.report.changed > 0;
    if (changed || made.report.folded > 0 || made.report.outside > 0 || made.report.not_finite > 0)
      report.lines.push_back(in_words(set.nodes[k].node->name, made.report));
    if (made.report.opaque_outside > 0)
      throw EditError(fmt::format(
          "{} of the {} welded vertices of \"{}\" are outside the cage, where these coordinates are undefined; use "
          "mean_value, or "
          "a coarser wrap or a larger cage",
          made.report.opaque_outside, made.report.points, set.nodes[k].node->name));
    // Renderer and files store positions as float.
    constexpr double farthest = 1e30;
    if (const Box box = transformed(made.object->bounds(), set.nodes[k].to_world);
        !box.isEmpty() && !(box.min().cwiseAbs().maxCoeff() < farthest && box.max().cwiseAbs().maxCoeff() < farthest))
      throw EditError(fmt::format("the coordinates of \"{}\" would be too large", set.nodes[k].node->name));
    result = with_changed(result, set.nodes[k].node->id, [&](Node& node) {
      // Without effect, only the flags of folded triangles may change; the node is new, so that tools see the step.
      if (changed || folded_triangles(*made.object) != folded_triangles(*node.object))
        node.object = std::move(made.object);
    });
    check_subtree(result, set.nodes[k].node->id);
  }
  if (report.lines.empty()) report.lines.emplace_back("nothing moved");
  for (const std::string& note : notes)
    for (std::string& line : report.lines) line += "; " + note;
  return {std::move(result), std::move(report)};
}

FieldType Codec<CageMoves>::type() {
  return {FieldKind::other,
          "list of {\"points\": numbers, or \"box\", or \"sphere\"; \"translate\", \"rotate\", \"scale\", \"pivot\"}",
          "Sequence[dict[str, Any]]",
          {}};
}
CageMoves Codec<CageMoves>::read(const nlohmann::json& value, const Scene& scene) {
  if (!value.is_array()) throw Error("must be a list of moves");
  CageMoves moves;
  for (const nlohmann::json& entry : value) {
    if (!entry.is_object()) throw Error("must be a list of objects, one per move");
    CageMove move;
    FieldReader reader(entry, scene);
    CageMove::fields(move, reader);
    reader.finish();
    if (int{!move.points.ranges.empty()} + int{move.box.has_value()} + int{move.sphere.has_value()} != 1)
      throw FieldError("points", "exactly one of points, box and sphere must be given");
    moves.push_back(std::move(move));
  }
  return moves;
}
nlohmann::json Codec<CageMoves>::write(const CageMoves& value) {
  nlohmann::json list = nlohmann::json::array();
  for (const CageMove& move : value) {
    nlohmann::json object = nlohmann::json::object();
    FieldWriter writer(object);
    CageMove::fields(move, writer);
    if (move.points.ranges.empty()) object.erase("points");
    list.push_back(std::move(object));
  }
  return list;
}

FieldType Codec<Cage>::type() {
  return {FieldKind::other,
          "file, or {\"vertices\": [[x, y, z], …], \"faces\": [[a, b, c], …]}",
          "str | dict[str, Any]",
          {}};
}
Cage Codec<Cage>::read(const nlohmann::json& value, const Scene& scene) {
  // The edit contains the file's mesh, so that journals and projects do not need the file.
  if (value.is_string()) return read_cage(value.get<std::string>());
  if (!value.is_object() || !value.contains("vertices") || !value.contains("faces") ||
      !value.at("vertices").is_array() || !value.at("faces").is_array())
    throw Error("must be a file name, or an object with vertices and faces");
  Cage cage;
  for (const nlohmann::json& vertex : value.at("vertices")) cage.vertices.push_back(Codec<Vec3>::read(vertex, scene));
  for (const nlohmann::json& corners : value.at("faces")) {
    Face face{};
    if (!corners.is_array() || corners.size() != 3) throw Error("faces must be lists of three vertex numbers");
    for (std::size_t k = 0; k < 3; ++k) {
      if (!corners[k].is_number_unsigned() || corners[k].get<std::uint64_t>() >= cage.vertices.size())
        throw Error("faces must name vertices by number, from 0");
      face[k] = corners[k].get<std::uint32_t>();
    }
    cage.faces.push_back(face);
  }
  return checked_cage(std::move(cage));
}
nlohmann::json Codec<Cage>::write(const Cage& value) {
  if (value.faces.empty()) return {};
  nlohmann::json object = {{"vertices", nlohmann::json::array()}, {"faces", nlohmann::json::array()}};
  for (const Vec3& v : value.vertices) object["vertices"].push_back(Codec<Vec3>::write(v));
  for (const Face& face : value.faces) object["faces"].push_back(face);
  return object;
}

namespace {

// A vertex in the units of a move's regions.
Vec3 in_region(const Vec3& vertex, const Box& box, bool shares) {
  if (!shares) return vertex;
  Vec3 p = vertex;
  for (int axis = 0; axis < 3; ++axis)
    p[axis] = box.sizes()[axis] > 0 ? (p[axis] - box.min()[axis]) / box.sizes()[axis] : 0;
  return p;
}

// Rounding errors of shares of a lattice's layers, so that boxes contain the layers on their sides wherever it lies.
Vec3 rounding_of_shares(const Box& box) {
  Vec3 room = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (const double size = box.sizes()[axis]; size > 0)
      room[axis] = 8 * std::numeric_limits<double>::epsilon() *
                   (1 + std::max(std::abs(box.min()[axis]), std::abs(box.max()[axis])) / size);
  return room;
}

double distance_between(const Vec3& a, const Vec3& b, const Box& box, bool shares) {
  const Vec3 way = a - b;
  return (shares ? Vec3(way.cwiseProduct(box.sizes())) : way).stableNorm();
}

}  // namespace

std::vector<std::uint32_t> points_of(const CageMove& move, const Cage& cage, bool shares) {
  std::vector<std::uint32_t> result;
  std::vector<std::uint8_t> taken(cage.vertices.size(), 0);
  for (const auto& [first, last] : move.points.ranges) {
    if (last >= cage.vertices.size())
      throw FieldError("points", fmt::format("{} is out of range: the cage has {} vertices, numbered from 0", last,
                                             cage.vertices.size()));
    std::fill(taken.begin() + static_cast<std::ptrdiff_t>(first), taken.begin() + static_cast<std::ptrdiff_t>(last) + 1,
              std::uint8_t{1});
  }
  for (std::uint32_t v = 0; v < taken.size(); ++v)
    if (taken[v] != 0) result.push_back(v);
  if (move.points.ranges.empty()) {
    const Box box = surface_box(cage);
    const std::vector<std::uint8_t> used = used_vertices(cage);
    const double unit = shares ? box.diagonal().stableNorm() : 1;
    double least = std::numeric_limits<double>::infinity();
    std::optional<std::uint32_t> nearest;
    for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
      if (used[v] == 0) continue;  // moves nothing
      const Vec3 p = in_region(cage.vertices[v], box, shares);
      if (move.box) {
        const Vec3 room = shares ? rounding_of_shares(box) : Vec3(Vec3::Zero());
        if ((p.array() >= (move.box->min - room).array()).all() && (p.array() <= (move.box->max + room).array()).all())
          result.push_back(v);
        continue;
      }
      const double away = distance_between(p, move.sphere->center, box, shares);
      if (away <= move.sphere->radius * unit) result.push_back(v);
      if (away < least) {
        least = away;
        nearest = v;
      }
    }
    if (result.empty() && move.nearest && nearest) result.push_back(*nearest);
    if (result.empty()) throw FieldError(move.box ? "box" : "sphere", "contains no cage vertex");
  }
  return result;
}

double distance_from_center(const CageMove& move, const Box& box, bool shares, const Vec3& vertex) {
  return distance_between(in_region(vertex, box, shares), move.sphere->center, box, shares);
}

std::vector<Vec3> moved_points(const CageMoves& moves, const Cage& cage, bool shares) {
  std::vector<Vec3> points = cage.vertices;
  const std::vector<std::uint8_t> used = used_vertices(cage);
  for (const CageMove& move : moves) {
    const std::vector<std::uint32_t> taken = points_of(move, cage, shares);
    Box box;
    for (const std::uint32_t v : taken)
      if (used[v] != 0) box.extend(points[v]);
    if (box.isEmpty()) box.extend(points[taken.front()]);
    const Vec3 pivot = move.pivot.value_or(box.center());
    const Mat3 linear = move.rotate.matrix() * move.scale.value.asDiagonal();
    for (const std::uint32_t v : taken) {
      // A pure translation is exact.
      points[v] = linear.isIdentity(0) ? Vec3(points[v] + move.translate)
                                       : Vec3(pivot + linear * (points[v] - pivot) + move.translate);
      if (!points[v].allFinite()) throw FieldError("moves", "the coordinates of a cage vertex would be too large");
    }
  }
  return points;
}

std::vector<std::string> cage_warnings(const Cage& cage, const std::vector<Vec3>& moved) {
  std::vector<std::string> notes;
  if (const std::size_t pairs = self_intersections(cage); pairs > 0)
    notes.push_back(
        fmt::format("the cage intersects itself ({})", counted(pairs, "pair of triangles", "pairs of triangles")));
  else if (const std::size_t after = self_intersections({moved, cage.faces}); after > 0)
    notes.push_back(fmt::format("the moved cage intersects itself ({})",
                                counted(after, "pair of triangles", "pairs of triangles")));
  else if (const std::size_t nested = nested_components(cage); nested > 0)
    notes.push_back(
        fmt::format("the cage has parts inside others ({}); turn their triangles over to make them cavities", nested));
  return notes;
}

namespace {

// wrap() with the result cache, because wraps are slow.
Cage cached_wrap(const TriangleList& triangles, double coarseness, const Progress& progress) {
  const std::shared_ptr<ResultCache> results = result_cache();
  if (!results) return wrap(triangles, coarseness, progress);
  const auto bytes_of = [](const auto& values) {
    return std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  const std::array<double, 1> setting{coarseness};
  const std::string key =
      result_key(wrap_version(),
                 std::string(bytes_of(setting)).append(bytes_of(triangles.points)).append(bytes_of(triangles.faces)));
  if (const auto bytes = results->find(key)) {
    try {
      return Codec<Cage>::read(nlohmann::json::from_cbor(*bytes), {});
    } catch (const std::exception&) {
      // The cached bytes are not a cage: computes it again.
    }
  }
  Cage cage = wrap(triangles, coarseness, progress);
  const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(Codec<Cage>::write(cage));
  results->keep(key, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return cage;
}

}  // namespace

Cage cage_of(const CageSource& source, const DeformSet& set, const Progress& progress) {
  if (int{!source.lattice.empty()} + int{source.wrap.has_value()} + int{!source.mesh.faces.empty()} > 1)
    throw FieldError("wrap", "at most one of lattice, wrap and mesh can be given");
  if (!source.mesh.faces.empty()) return source.mesh;
  if (source.lattice.empty()) {
    const TriangleList opaque = set.opaque_triangles();
    if (opaque.faces.empty())
      throw EditError("all triangles are transparent, so there is nothing to wrap; use a lattice");
    return cached_wrap(opaque, source.wrap.value_or(0.1), progress);
  }
  if (source.lattice.size() != 3) throw FieldError("lattice", "must be three whole numbers: cells along x, y and z");
  // Enlarges the box by 1 % of its diagonal, so that no point lies on the cage.
  Box box = set.bounds();
  const Vec3 margin = Vec3::Constant(0.01 * box.diagonal().stableNorm());
  box = Box(Vec3(box.min() - margin), Vec3(box.max() + margin));
  try {
    return lattice_cage(box, source.lattice[0], source.lattice[1], source.lattice[2]);
  } catch (const FieldError&) {
    throw;
  } catch (const Error& error) {
    throw FieldError("lattice", error.what());
  }
}

}  // namespace rebake
