#include "mesh_ops/deform/deform_object.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

namespace bgi = boost::geometry::index;
using TreePoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// Fades the deformation out towards the border.
using TreeSegment = boost::geometry::model::segment<TreePoint>;

// A piece of the border: an edge that a deformed and another triangle share, or a corner that they do.
struct BorderPiece {
  Vec3 begin, end;

  Vec3 nearest(const Vec3& p) const {
    const Vec3 along = end - begin;
    const double square = along.squaredNorm();
    return begin + (square > 0 ? std::clamp((p - begin).dot(along) / square, 0.0, 1.0) : 0.0) * along;
  }
};

void fade(const std::vector<Vec3>& rest, const std::vector<BorderPiece>& border, double falloff,
          DeformedPoints& deformed) {
  if (border.empty()) return;
  // In a box of size 1, so that no square of a distance overflows.
  Box box;
  for (const BorderPiece& piece : border) {
    box.extend(piece.begin);
    box.extend(piece.end);
  }
  for (const Vec3& p : rest)
    if (p.allFinite()) box.extend(p);
  const double size = box.sizes().maxCoeff() > 0 ? box.sizes().maxCoeff() : 1;
  const auto point = [&](const Vec3& p) {
    const Vec3 q = (p - box.min()) / size;
    return TreePoint(q.x(), q.y(), q.z());
  };
  std::vector<std::pair<TreeSegment, std::uint32_t>> entries;
  for (std::uint32_t i = 0; i < border.size(); ++i)
    entries.emplace_back(TreeSegment(point(border[i].begin), point(border[i].end)), i);
  const bgi::rtree<std::pair<TreeSegment, std::uint32_t>, bgi::linear<16>> tree(entries);
  tbb::parallel_for(std::size_t{0}, rest.size(), [&](std::size_t i) {
    if (!rest[i].allFinite()) return;
    const auto found = tree.qbegin(bgi::nearest(point(rest[i]), 1));
    const Vec3 away = rest[i] - border[found->second].nearest(rest[i]);
    const double distance = away.stableNorm(), t = distance / falloff;
    if (t >= 1) return;
    const double share = t * t * (3 - 2 * t);
    // The slope is zero where the distance is, so that its direction need not exist there.
    const Vec3 slope = distance > 0 ? Vec3(away * (6 * t * (1 - t) / falloff / distance)) : Vec3(0, 0, 0);
    const Vec3 motion = deformed.points[i] - rest[i];
    deformed.points[i] = share > 0 ? Vec3(rest[i] + share * motion) : rest[i];
    deformed.jacobians[i] =
        Mat3::Identity() + share * (deformed.jacobians[i] - Mat3::Identity()) + motion * slope.transpose();
  });
}

// Edges first, then corners that no such edge has.
std::vector<BorderPiece> border_of(const std::vector<std::uint32_t>& places, const std::vector<std::uint32_t>& number,
                                   const std::vector<std::uint8_t>& shared, const TriangleSet& flags,
                                   const std::vector<Vec3>& world) {
  const auto is_border = [&](std::uint32_t place) {
    return number[place] != none && shared[place] != 0 && world[number[place]].allFinite();
  };
  const auto for_edges = [&](bool flagged, const auto& visit) {
    for (std::size_t t = 0; t < flags.size(); ++t) {
      if ((flags[t] != 0) != flagged) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = places[t * 3 + k], b = places[t * 3 + (k + 1) % 3];
        if (a != b && is_border(a) && is_border(b)) visit(std::pair(std::min(a, b), std::max(a, b)));
      }
    }
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> kept, edges;
  for_edges(false, [&](const auto& edge) { kept.push_back(edge); });
  std::sort(kept.begin(), kept.end());
  for_edges(true, [&](const auto& edge) {
    if (std::binary_search(kept.begin(), kept.end(), edge)) edges.push_back(edge);
  });
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<std::uint8_t> on_edge(number.size(), 0);
  std::vector<BorderPiece> border;
  for (const auto& [a, b] : edges) {
    on_edge[a] = on_edge[b] = 1;
    border.push_back({world[number[a]], world[number[b]]});
  }
  for (std::uint32_t place = 0; place < number.size(); ++place)
    if (is_border(place) && on_edge[place] == 0) border.push_back({world[number[place]], world[number[place]]});
  return border;
}

}  // namespace

DeformedObject deformed(const BakedObject& object, const Affine& to_world, const TriangleSet& flags, double falloff,
                        const SpaceDeformation& deformation) {
  const auto corners = corners_of(object);
  // Places of flagged triangles, numbered anew; and which of them others share.
  std::vector<std::uint32_t> number(corners->place_count, none);
  std::vector<std::uint8_t> shared(corners->place_count, 0);
  std::vector<Vec3> rest;
  std::size_t triangle = 0;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t place = corners->places[triangle * 3 + k];
        if (flags[triangle] == 0) {
          shared[place] = 1;
        } else if (number[place] == none) {
          number[place] = static_cast<std::uint32_t>(rest.size());
          rest.push_back(set.soup.positions()[face[k]]);
        }
      }
      ++triangle;
    }
  std::vector<Vec3> world(rest.size());
  std::transform(rest.begin(), rest.end(), world.begin(), [&](const Vec3& p) { return to_world * p; });
  DeformedPoints moved = deformation(world);
  if (falloff > 0) {
    fade(world, border_of(corners->places, number, shared, flags, world), falloff, moved);
  }

  DeformedObject result;
  DeformationReport& report = result.report;
  report.points = rest.size();
  const Affine to_object = to_world.inverse();
  // Turns live in the object's own frame: orthogonal, whatever its transform scales.
  const Mat3 frame = orthogonal_factor(to_world.linear());
  const Mat3 scales = to_world.linear() * frame.transpose();
  std::vector<Mat3> turns(rest.size(), Mat3::Identity());
  std::vector<double> determinants(rest.size(), 1);
  std::vector<std::uint8_t> defined(rest.size(), 1), is_number(rest.size(), 1);
  tbb::parallel_for(std::size_t{0}, rest.size(), [&](std::size_t i) {
    if (!world[i].allFinite() || !moved.points[i].allFinite() || !moved.jacobians[i].allFinite()) {
      moved.points[i] = world[i];
      is_number[i] = 0;
      return;
    }
    determinants[i] = moved.jacobians[i].determinant();
    if (moved.points[i] == world[i] && moved.jacobians[i].isIdentity(0)) return;
    const LocalRotation local = local_rotation(moved.jacobians[i] * scales);
    defined[i] = local.defined ? 1 : 0;
    turns[i] = frame.transpose() * local.rotation * frame;
  });
  if (std::any_of(moved.outside.begin(), moved.outside.end(), [](auto flag) { return flag != 0; })) {
    std::vector<std::uint8_t> shows(rest.size(), 0);
    std::size_t t = 0;
    for (const TextureSet& set : object.sets)
      for (const std::uint8_t opaque : faces_with_opaque_texels(set)) {
        if (flags[t] != 0 && opaque != 0)
          for (std::size_t k = 0; k < 3; ++k) shows[number[corners->places[t * 3 + k]]] = 1;
        ++t;
      }
    for (std::size_t i = 0; i < rest.size(); ++i) report.opaque_outside += shows[i] & moved.outside[i];
  }
  bool any = false;  // of those that are numbers
  for (std::size_t i = 0; i < rest.size(); ++i) {
    report.not_finite += is_number[i] != 0 ? 0 : 1;
    report.outside += !moved.outside.empty() && moved.outside[i] != 0 ? 1 : 0;
    report.folded += determinants[i] <= 0 ? 1 : 0;
    report.undefined += defined[i] == 0 ? 1 : 0;
    if (is_number[i] == 0) continue;
    report.least_determinant = any ? std::min(report.least_determinant, determinants[i]) : determinants[i];
    any = true;
  }
  // Where two rotations are equally near, that of a place beside it: from those that have one outwards.
  if (report.undefined > 0) {
    std::vector<std::vector<std::uint32_t>> beside(rest.size());
    for (std::size_t t = 0; t < flags.size(); ++t) {
      if (flags[t] == 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = number[corners->places[t * 3 + k]], b = number[corners->places[t * 3 + (k + 1) % 3]];
        if (defined[a] != 0 && defined[b] != 0) continue;
        beside[a].push_back(b);
        beside[b].push_back(a);
      }
    }
    std::vector<std::uint32_t> next;
    for (std::uint32_t i = 0; i < rest.size(); ++i)
      if (defined[i] != 0 && !beside[i].empty()) next.push_back(i);
    for (std::size_t at = 0; at < next.size(); ++at)
      for (const std::uint32_t i : beside[next[at]]) {
        if (defined[i] != 0) continue;
        turns[i] = turns[next[at]];
        defined[i] = 1;
        next.push_back(i);
      }
  }

  auto made = std::make_shared<BakedObject>(object);
  auto folded = std::make_shared<TriangleSet>(flags.size(), std::uint8_t{0});
  std::size_t first = 0;
  for (TextureSet& set : made->sets) {
    const std::size_t total = set.soup.triangle_count();
    std::vector<std::uint32_t> place_of(set.soup.positions().size(), none);
    for (std::size_t f = 0; f < total; ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        if (flags[first + f] == 0) continue;
        const std::uint32_t i = number[corners->places[(first + f) * 3 + k]];
        place_of[set.soup.faces()[f][k]] = i;
        if (determinants[i] <= 0) (*folded)[first + f] = 1;
      }
    set.soup = change_vertices(set.soup, flags, first, [&](std::uint32_t v, Vec3& position, Mat3& turn) {
      const std::uint32_t i = place_of[v];
      if (world[i].allFinite() && moved.points[i] != world[i]) position = to_object * moved.points[i];
      if (!turns[i].isIdentity(0)) turn = orthogonal_factor(turns[i] * turn);
    });
    first += total;
  }
  made->folded = report.folded > 0 ? std::move(folded) : nullptr;
  result.object = std::move(made);
  return result;
}

}  // namespace rebake
