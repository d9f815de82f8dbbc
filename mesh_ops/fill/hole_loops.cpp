#include "mesh_ops/fill/hole_loops.h"

#include <algorithm>
#include <map>

#include "mesh_ops/index/index.h"
#include "mesh_ops/index/weld.h"

namespace rebake {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // places, lower first

struct Side {
  std::uint32_t removed = 0, kept = 0;  // number of opaque triangles
  std::uint32_t triangle = 0;           // the last kept one
  std::uint32_t outer = 0;              // place of its third corner
};

struct Object {
  WeldedCorners corners;
  std::vector<Vec3> points;  // per place
  TriangleSet opaque;        // triangles that show opaque texels
};

Object welded(const BakedObject& object, double tolerance) {
  std::vector<std::shared_ptr<const WeldedSet>> sets;
  for (const TextureSet& set : object.sets) sets.push_back(std::make_shared<const WeldedSet>(weld_set(set.soup)));
  Object result{weld(object, sets, tolerance), {}, {}};
  result.points.resize(result.corners.place_count);
  std::size_t corner = 0;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces())
      for (const std::uint32_t vertex : face)
        result.points[result.corners.places[corner++]] = set.soup.positions()[vertex];
  for (const TriangleTraits& traits : *traits_of(object)) result.opaque.push_back(traits.opacity > 0 ? 1 : 0);
  return result;
}

// Follows border edges into closed loops. Each edge is used once; a place that is met twice closes a loop.
std::vector<std::vector<std::uint32_t>> closed_loops(std::map<std::uint32_t, std::vector<std::uint32_t>>& next,
                                                     std::size_t& open_edges) {
  std::vector<std::vector<std::uint32_t>> loops;
  const auto remove_edge = [&](std::uint32_t a, std::uint32_t b) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      auto& list = next[from];
      list.erase(std::find(list.begin(), list.end(), to));
    }
  };
  for (auto& [start, neighbours] : next)
    while (!neighbours.empty()) {
      std::vector<std::uint32_t> path{start};
      std::map<std::uint32_t, std::size_t> at{{start, 0}};
      while (!next[path.back()].empty()) {
        const std::uint32_t from = path.back(), to = next[from].front();
        remove_edge(from, to);
        const auto met = at.find(to);
        if (met == at.end()) {
          at[to] = path.size();
          path.push_back(to);
          continue;
        }
        std::vector<std::uint32_t> loop(path.begin() + static_cast<std::ptrdiff_t>(met->second), path.end());
        for (std::size_t k = met->second + 1; k < path.size(); ++k) at.erase(path[k]);
        path.resize(met->second + 1);
        if (loop.size() >= 3)
          loops.push_back(std::move(loop));
        else
          open_edges += loop.size();
      }
      open_edges += path.size() - 1;
    }
  return loops;
}

}  // namespace

namespace {

// The sides of all edges, and per place the corners there that count as kept.
struct Edges {
  std::map<Edge, Side> sides;
  std::map<std::uint32_t, std::vector<HoleLoop::Corner>> corners;
};

// `removed`: triangles on the far side of a border; nothing for open borders.
Edges edges_of(const Object& all, const TriangleSet* removed) {
  Edges edges;
  for (std::uint32_t f = 0; f < all.opaque.size(); ++f) {
    if (all.opaque[f] == 0) continue;
    const bool is_removed = removed != nullptr && (*removed)[f] != 0;
    const std::uint32_t* places = &all.corners.places[3 * std::size_t{f}];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = places[k], b = places[(k + 1) % 3];
      if (!is_removed) edges.corners[a].push_back({f, k});
      if (a == b) continue;
      Side& side = edges.sides[std::minmax(a, b)];
      ++(is_removed ? side.removed : side.kept);
      if (is_removed) continue;
      side.triangle = f;
      side.outer = places[(k + 2) % 3];
    }
  }
  return edges;
}

template <class IsBorder>
HoleLoops loops_of(const Object& all, const Edges& edges, IsBorder is_border) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> next;
  for (const auto& [edge, side] : edges.sides) {
    if (!is_border(side)) continue;
    next[edge.first].push_back(edge.second);
    next[edge.second].push_back(edge.first);
  }
  HoleLoops result;
  for (const std::vector<std::uint32_t>& places : closed_loops(next, result.open_edges)) {
    HoleLoop loop;
    for (std::size_t k = 0; k < places.size(); ++k) {
      loop.points.push_back(all.points[places[k]]);
      loop.outer_points.push_back(
          all.points[edges.sides.at(std::minmax(places[k], places[(k + 1) % places.size()])).outer]);
      loop.corners.push_back(edges.corners.at(places[k]));
    }
    result.loops.push_back(std::move(loop));
  }
  std::stable_sort(result.loops.begin(), result.loops.end(),
                   [](const HoleLoop& a, const HoleLoop& b) { return a.points.size() > b.points.size(); });
  return result;
}

}  // namespace

HoleLoops hole_loops(const BakedObject& object, const TriangleSet& removed, double tolerance) {
  const Object all = welded(object, tolerance);
  return loops_of(all, edges_of(all, &removed), [](const Side& side) { return side.removed > 0 && side.kept > 0; });
}

HoleLoops open_loops(const BakedObject& object, const TriangleSet& flagged, double tolerance) {
  const Object all = welded(object, tolerance);
  return loops_of(all, edges_of(all, nullptr),
                  [&](const Side& side) { return side.kept == 1 && flagged[side.triangle] != 0; });
}

}  // namespace rebake
