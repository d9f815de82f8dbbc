#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/union_find.h"
#include "mesh_ops/light/learned/disk_chart.h"
#include "mesh_ops/mesh/manifold_mesh.h"

namespace rebake {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using EdgeHandle = ManifoldMesh::EdgeHandle;

// The two faces at an interior edge.
std::pair<std::uint32_t, std::uint32_t> faces_at(const ManifoldMesh& mesh, EdgeHandle edge) {
  const auto face = [&](unsigned side) {
    return static_cast<std::uint32_t>(mesh.face_handle(mesh.halfedge_handle(edge, side)).idx());
  };
  return {face(0), face(1)};
}

// Throws Error unless the mesh is connected, manifold and consistently oriented.
ManifoldMesh connected_mesh(const ProxyMesh& proxy) {
  if (proxy.faces.empty()) throw Error("the mesh has no triangles");
  ManifoldMesh mesh = manifold_mesh(proxy.vertices, proxy.faces);
  UnionFind pieces(proxy.faces.size());
  std::size_t count = proxy.faces.size();
  for (const EdgeHandle edge : mesh.edges()) {
    if (mesh.is_boundary(edge)) continue;
    const auto [first, second] = faces_at(mesh, edge);
    if (pieces.join(first, second)) --count;
  }
  if (count > 1) throw Error("the mesh is not connected: it has more than one component");
  return mesh;
}

// At least two vertices by farthest-point sampling, with distances along edges (Dijkstra).
std::set<std::uint32_t> farthest_vertices(const ProxyMesh& proxy, const ManifoldMesh& mesh, int count) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto from = [&](const std::set<std::uint32_t>& sources) {
    std::vector<double> distance(proxy.vertices.size(), infinity);
    using Reached = std::pair<double, std::uint32_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
    for (const std::uint32_t v : sources) queue.emplace(distance[v] = 0, v);
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance[v]) continue;
      for (const auto neighbour : mesh.vv_range(mesh.vertex_handle(v))) {
        const auto w = static_cast<std::uint32_t>(neighbour.idx());
        if (const double to = d + (proxy.vertices[v] - proxy.vertices[w]).norm(); to < distance[w])
          queue.emplace(distance[w] = to, w);
      }
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
  std::set<std::uint32_t> tips{from({proxy.faces.front()[0]})};
  while (tips.size() < static_cast<std::size_t>(std::max(2, count)))
    if (!tips.insert(from(tips)).second) break;
  return tips;
}

// Interior edges by dihedral angle, the flattest first.
std::vector<EdgeHandle> flattest_edges(const ProxyMesh& proxy, const ManifoldMesh& mesh) {
  const auto normal = [&](std::uint32_t f) -> Vec3 {
    const Face& face = proxy.faces[f];
    const Vec3& a = proxy.vertices[face[0]];
    return (proxy.vertices[face[1]] - a).cross(proxy.vertices[face[2]] - a).stableNormalized();
  };
  std::vector<std::tuple<double, Edge, EdgeHandle>> edges;
  for (const EdgeHandle edge : mesh.edges()) {
    if (mesh.is_boundary(edge)) continue;
    const auto [first, second] = faces_at(mesh, edge);
    edges.emplace_back(-normal(first).dot(normal(second)), vertices_of(mesh, edge), edge);
  }
  std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
    return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
  });
  std::vector<EdgeHandle> sorted;
  for (const auto& [bend, ends, edge] : edges) sorted.push_back(edge);
  return sorted;
}

}  // namespace

std::vector<Edge> seams_of(const ProxyMesh& proxy, int tips) {
  const ManifoldMesh mesh = connected_mesh(proxy);
  // A spanning tree of the faces over the flattest edges is a disk. The other edges form the cut graph (tree–cotree
  // decomposition, Eppstein 2003).
  UnionFind joined(proxy.faces.size());
  std::set<Edge> graph;
  for (const EdgeHandle edge : flattest_edges(proxy, mesh)) {
    const auto [first, second] = faces_at(mesh, edge);
    if (!joined.join(first, second)) graph.insert(vertices_of(mesh, edge));
  }
  bool border = false;
  std::vector<int> degree(proxy.vertices.size(), 0);
  const auto count_ends = [&](const Edge& edge) {
    ++degree[edge.first];
    ++degree[edge.second];
  };
  for (const EdgeHandle edge : mesh.edges())
    if (mesh.is_boundary(edge)) {
      border = true;
      count_ends(vertices_of(mesh, edge));
    }
  for (const Edge& edge : graph) count_ends(edge);
  // Prune dangling branches of the cut graph, except those that end at a tip.
  const std::set<std::uint32_t> kept = border ? std::set<std::uint32_t>{} : farthest_vertices(proxy, mesh, tips);
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

DiskChart cut_along(const ProxyMesh& proxy, const std::vector<Edge>& seams) {
  const ManifoldMesh mesh = connected_mesh(proxy);
  const std::set<Edge> cut(seams.begin(), seams.end());
  // Corners of a vertex share one copy if their faces are adjacent across an uncut edge.
  UnionFind corners(proxy.faces.size() * 3);
  const auto corner = [&](std::uint32_t f, std::uint32_t v) {
    for (std::uint32_t k = 0; k < 3; ++k)
      if (proxy.faces[f][k] == v) return 3 * f + k;
    return 3 * f;
  };
  for (const EdgeHandle edge : mesh.edges()) {
    const Edge ends = vertices_of(mesh, edge);
    if (mesh.is_boundary(edge) || cut.contains(ends)) continue;
    const auto [first, second] = faces_at(mesh, edge);
    for (const std::uint32_t v : {ends.first, ends.second}) corners.join(corner(first, v), corner(second, v));
  }
  DiskChart chart;
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t f = 0; f < proxy.faces.size(); ++f) {
    Face face{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [it, fresh] = number.emplace(corners.root(3 * f + k), static_cast<std::uint32_t>(chart.source.size()));
      if (fresh) chart.source.push_back(proxy.faces[f][k]);
      face[k] = it->second;
    }
    chart.faces.push_back(face);
  }
  return chart;
}

}  // namespace rebake
