#include "mesh_ops/select/morphology.h"

#include <cstdint>
#include <limits>
#include <vector>

#include "mesh_ops/base/union_find.h"

namespace rebake {

TriangleSet grown(const WeldedCorners& corners, const TriangleSet& selection) {
  std::vector<std::uint8_t> touched(corners.place_count, 0);
  for (std::size_t t = 0; t < selection.size(); ++t)
    if (selection[t] != 0)
      for (std::size_t k = 0; k < 3; ++k) touched[corners.places[t * 3 + k]] = 1;
  TriangleSet result(selection.size(), 0);
  for (std::size_t t = 0; t < selection.size(); ++t)
    result[t] =
        touched[corners.places[t * 3]] | touched[corners.places[t * 3 + 1]] | touched[corners.places[t * 3 + 2]];
  return result;
}

TriangleSet shrunk(const WeldedCorners& corners, const TriangleSet& selection) {
  TriangleSet outside(selection.size());
  for (std::size_t t = 0; t < selection.size(); ++t) outside[t] = selection[t] != 0 ? 0 : 1;
  TriangleSet result = grown(corners, outside);
  for (auto& flag : result) flag = flag != 0 ? 0 : 1;
  return result;
}

TriangleSet filled(const EdgeTable& edges, const TriangleSet& selection, std::size_t largest) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  UnionFind islands(selection.size());
  std::vector<std::uint32_t> beside;  // unselected triangles that share an edge with a selected one
  for (std::size_t edge = 0; edge + 1 < edges.first_of.size(); ++edge) {
    bool borders = false;
    std::uint32_t open = none;
    for (std::uint32_t i = edges.first_of[edge]; i < edges.first_of[edge + 1]; ++i) {
      const std::uint32_t t = edges.half_edges[i] / 3;
      if (selection[t] != 0)
        borders = true;
      else if (open == none)
        open = t;
      else
        islands.join(open, t);
    }
    if (borders && open != none) beside.push_back(open);
  }
  std::vector<std::uint32_t> size(selection.size(), 0);
  std::vector<std::uint8_t> borders(selection.size(), 0);
  for (std::uint32_t t = 0; t < selection.size(); ++t)
    if (selection[t] == 0) ++size[islands.root(t)];
  for (const std::uint32_t t : beside) borders[islands.root(t)] = 1;
  TriangleSet result = selection;
  for (std::uint32_t t = 0; t < selection.size(); ++t) {
    const std::uint32_t root = islands.root(t);
    if (selection[t] == 0 && borders[root] != 0 && size[root] < largest) result[t] = 1;
  }
  return result;
}

TriangleSet connected_within(const WeldedCorners& corners, const TriangleSet& within, const TriangleSet& from) {
  UnionFind parts(corners.place_count);
  const std::vector<std::uint32_t>& places = corners.places;
  for (std::size_t t = 0; t < within.size(); ++t)
    if (within[t] != 0 || from[t] != 0)
      for (std::size_t k = 1; k < 3; ++k) parts.join(places[t * 3], places[t * 3 + k]);
  std::vector<std::uint8_t> wanted(corners.place_count, 0);
  for (std::size_t t = 0; t < from.size(); ++t)
    if (from[t] != 0) wanted[parts.root(places[t * 3])] = 1;
  TriangleSet result(within.size(), 0);
  for (std::size_t t = 0; t < within.size(); ++t)
    if (within[t] != 0) result[t] = wanted[parts.root(places[t * 3])];
  return result;
}

TriangleSet connected_to(const WeldedCorners& corners, std::size_t triangle) {
  UnionFind parts(corners.place_count);
  const std::vector<std::uint32_t>& places = corners.places;
  TriangleSet flags(places.size() / 3, 0);
  for (std::size_t t = 0; t < flags.size(); ++t)
    for (std::size_t k = 1; k < 3; ++k) parts.join(places[t * 3], places[t * 3 + k]);
  const std::uint32_t wanted = parts.root(places.at(triangle * 3));
  for (std::size_t t = 0; t < flags.size(); ++t) flags[t] = parts.root(places[t * 3]) == wanted ? 1 : 0;
  return flags;
}

}  // namespace rebake
