#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/union_find.h"
#include "mesh_ops/light/disk_chart.h"

namespace rebake {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

// The faces at an edge.
struct Sides {
  std::vector<std::uint32_t> faces;
  int balance = 0;  // number of faces that traverse the edge forwards, minus backwards
};

// The edges and their faces. Throws Error unless the mesh is connected, manifold and consistently oriented.
std::map<Edge, Sides> edges_of(const ProxyMesh& mesh) {
  std::map<Edge, Sides> edges;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      if (a == b || a >= mesh.vertices.size() || b >= mesh.vertices.size())
        throw Error("a triangle uses a vertex twice, or a vertex index out of range");
      Sides& sides = edges[edge_of(a, b)];
      sides.faces.push_back(f);
      sides.balance += a < b ? 1 : -1;
    }
  if (edges.empty()) throw Error("the mesh has no triangles");
  UnionFind pieces(mesh.faces.size());
  std::size_t count = mesh.faces.size();
  for (const auto& [edge, sides] : edges) {
    if (sides.faces.size() > 2) throw Error("the mesh is not manifold: more than two triangles share an edge");
    if (sides.faces.size() == 2 && sides.balance != 0)
      throw Error("the mesh is not consistently oriented: two adjacent triangles face opposite ways");
    if (sides.faces.size() == 2 && pieces.join(sides.faces[0], sides.faces[1])) --count;
  }
  if (count > 1) throw Error("the mesh is not connected: it has more than one component");
  return edges;
}

// At least two vertices by farthest-point sampling, with distances along edges (Dijkstra).
std::set<std::uint32_t> farthest_vertices(const ProxyMesh& mesh, const std::map<Edge, Sides>& edges, int count) {
  std::vector<std::vector<std::uint32_t>> around(mesh.vertices.size());
  for (const auto& [edge, sides] : edges) {
    around[edge.first].push_back(edge.second);
    around[edge.second].push_back(edge.first);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  const auto from = [&](const std::set<std::uint32_t>& sources) {
    std::vector<double> distance(mesh.vertices.size(), infinity);
    using Reached = std::pair<double, std::uint32_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
    for (const std::uint32_t v : sources) queue.emplace(distance[v] = 0, v);
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance[v]) continue;
      for (const std::uint32_t w : around[v])
        if (const double to = d + (mesh.vertices[v] - mesh.vertices[w]).norm(); to < distance[w])
          queue.emplace(distance[w] = to, w);
    }
    std::uint32_t farthest = *sources.begin();
    double most = 0;
    for (std::uint32_t v = 0; v < distance.size(); ++v)
      if (std::isfinite(distance[v]) && distance[v] > most) {
        most = distance[v];
        farthest = v;
      }
    return farthest;
  };
  std::set<std::uint32_t> tips{from({mesh.faces.front()[0]})};
  while (tips.size() < static_cast<std::size_t>(std::max(2, count)))
    if (!tips.insert(from(tips)).second) break;
  return tips;
}

}  // namespace

std::vector<Edge> seams_of(const ProxyMesh& mesh, int tips) {
  const std::map<Edge, Sides> edges = edges_of(mesh);
  const auto normal = [&](std::uint32_t f) -> Vec3 {
    const Face& face = mesh.faces[f];
    const Vec3& a = mesh.vertices[face[0]];
    return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).stableNormalized();
  };
  bool border = false;
  std::vector<std::pair<double, Edge>> flat;  // interior edges by dihedral angle, flattest first
  for (const auto& [edge, sides] : edges) {
    border = border || sides.faces.size() == 1;
    if (sides.faces.size() == 2) flat.emplace_back(-normal(sides.faces[0]).dot(normal(sides.faces[1])), edge);
  }
  std::stable_sort(flat.begin(), flat.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  // A spanning tree of the faces over the flattest edges is a disk. The other edges form the cut graph (tree–cotree
  // decomposition, Eppstein 2003).
  UnionFind joined(mesh.faces.size());
  std::set<Edge> graph;
  for (const auto& [bend, edge] : flat) {
    const Sides& sides = edges.at(edge);
    if (!joined.join(sides.faces[0], sides.faces[1])) graph.insert(edge);
  }
  std::vector<int> degree(mesh.vertices.size(), 0);
  for (const auto& [edge, sides] : edges)
    if (sides.faces.size() == 1 || graph.contains(edge)) {
      ++degree[edge.first];
      ++degree[edge.second];
    }
  // Prune dangling branches of the cut graph, except those that end at a tip.
  const std::set<std::uint32_t> kept = border ? std::set<std::uint32_t>{} : farthest_vertices(mesh, edges, tips);
  for (bool any = true; any;) {
    any = false;
    for (auto it = graph.begin(); it != graph.end();) {
      const auto loose = [&](std::uint32_t v) { return degree[v] == 1 && !kept.contains(v); };
      if (!loose(it->first) && !loose(it->second)) {
        ++it;
        continue;
      }
      --degree[it->first];
      --degree[it->second];
      it = graph.erase(it);
      any = true;
    }
  }
  return {graph.begin(), graph.end()};
}

DiskChart cut_along(const ProxyMesh& mesh, const std::vector<Edge>& seams) {
  const std::map<Edge, Sides> edges = edges_of(mesh);
  const std::set<Edge> cut(seams.begin(), seams.end());
  // Corners of a vertex share one copy if their faces are adjacent across an uncut edge.
  UnionFind corners(mesh.faces.size() * 3);
  const auto corner = [&](std::uint32_t f, std::uint32_t v) {
    for (std::uint32_t k = 0; k < 3; ++k)
      if (mesh.faces[f][k] == v) return 3 * f + k;
    return 3 * f;
  };
  for (const auto& [edge, sides] : edges) {
    if (sides.faces.size() != 2 || cut.contains(edge)) continue;
    for (const std::uint32_t v : {edge.first, edge.second})
      corners.join(corner(sides.faces[0], v), corner(sides.faces[1], v));
  }
  DiskChart chart;
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    Face face{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [it, fresh] = number.emplace(corners.root(3 * f + k), static_cast<std::uint32_t>(chart.source.size()));
      if (fresh) chart.source.push_back(mesh.faces[f][k]);
      face[k] = it->second;
    }
    chart.faces.push_back(face);
  }
  return chart;
}

}  // namespace rebake
