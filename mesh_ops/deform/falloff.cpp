#include "mesh_ops/deform/falloff.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <utility>

namespace rebake {

namespace {

namespace bgi = boost::geometry::index;
using TreePoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using TreeSegment = boost::geometry::model::segment<TreePoint>;

}  // namespace

Vec3 BorderPiece::nearest(const Vec3& p) const {
  const Vec3 along = end - begin;
  const double square = along.squaredNorm();
  return begin + (square > 0 ? std::clamp((p - begin).dot(along) / square, 0.0, 1.0) : 0.0) * along;
}

void fade_out(const std::vector<Vec3>& rest, const std::vector<BorderPiece>& border, double falloff,
              DeformedPoints& deformed) {
  if (border.empty()) return;
  // Scaled to a border of size 1, so that squared distances overflow only where the falloff does not reach, and a point
  // far away does not blur the border.
  Box box;
  for (const BorderPiece& piece : border) {
    box.extend(piece.begin);
    box.extend(piece.end);
  }
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
    // At distance 0 the gradient of the share is 0, so its direction is not needed.
    const Vec3 slope = distance > 0 ? Vec3(away * (6 * t * (1 - t) / falloff / distance)) : Vec3(0, 0, 0);
    const Vec3 motion = deformed.points[i] - rest[i];
    deformed.points[i] = share > 0 ? Vec3(rest[i] + share * motion) : rest[i];
    deformed.jacobians[i] =
        Mat3::Identity() + share * (deformed.jacobians[i] - Mat3::Identity()) + motion * slope.transpose();
  });
}

std::vector<BorderPiece> border_of(const WeldedCorners& corners, const TriangleSet& flags,
                                   const FlaggedPositions& places) {
  const auto is_border = [&](std::uint32_t place) {
    return places.number_of[place] != FlaggedPositions::none && places.shared[place] != 0 &&
           places.world[places.number_of[place]].allFinite();
  };
  const auto for_edges = [&](bool flagged, const auto& visit) {
    for (std::size_t t = 0; t < flags.size(); ++t) {
      if ((flags[t] != 0) != flagged) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = corners.places[t * 3 + k], b = corners.places[t * 3 + (k + 1) % 3];
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
  std::vector<std::uint8_t> on_edge(places.number_of.size(), 0);
  std::vector<BorderPiece> border;
  for (const auto& [a, b] : edges) {
    on_edge[a] = on_edge[b] = 1;
    border.push_back({places.world[places.number_of[a]], places.world[places.number_of[b]]});
  }
  for (std::uint32_t place = 0; place < places.number_of.size(); ++place)
    if (is_border(place) && on_edge[place] == 0)
      border.push_back({places.world[places.number_of[place]], places.world[places.number_of[place]]});
  return border;
}

}  // namespace rebake
