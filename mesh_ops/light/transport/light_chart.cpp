#include "mesh_ops/light/transport/light_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "mesh_ops/base/shelf_packer.h"
#include "mesh_ops/base/union_find.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/index/texel_patches.h"

namespace rebake {

namespace {

struct Patch {
  TexelRect rect;
  int columns, rows;      // numbers of nodes
  int left = 0, top = 0;  // position in the grid, in nodes
  std::vector<std::uint32_t> faces;

  double step_x() const { return static_cast<double>(rect.width()) / std::max(1, columns - 1); }
  double step_y() const { return static_cast<double>(rect.height()) / std::max(1, rows - 1); }
};

// Surfaces that share texels may be lit differently. Returns per face an identifier of its connected component within
// its patch, over edges that are equal in space and in the texture.
std::vector<std::size_t> surfaces_of(const TextureSet& set, const TexelPatches& found) {
  std::vector<std::vector<std::uint32_t>> faces(found.rects.size());
  for (std::uint32_t f = 0; f < found.of_face.size(); ++f) faces[found.of_face[f]].push_back(f);
  UnionFind surfaces(found.of_face.size());
  using Corner = std::array<double, 5>;  // position and UV
  struct Edge {
    std::array<Corner, 2> ends;
    std::uint32_t face;
  };
  std::vector<Edge> edges;
  std::vector<std::array<std::array<double, 2>, 3>> triangles;
  for (const std::vector<std::uint32_t>& patch : faces) {
    // Only patches with coincident triangles in the texture are split. Any other patch is one surface, even if its
    // parts have been moved.
    triangles.clear();
    for (const std::uint32_t f : patch) {
      auto& corners = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2& uv = set.soup.uvs()[set.soup.faces()[f][k]];
        corners[k] = {uv.x(), uv.y()};
      }
      std::sort(corners.begin(), corners.end());
    }
    std::sort(triangles.begin(), triangles.end());
    if (std::adjacent_find(triangles.begin(), triangles.end()) == triangles.end()) {
      for (const std::uint32_t f : patch) surfaces.join(f, patch.front());
      continue;
    }
    // Faces that share a vertex share its place in the chart.
    std::map<std::uint32_t, std::uint32_t> face_of;
    for (const std::uint32_t f : patch)
      for (const std::uint32_t v : set.soup.faces()[f]) surfaces.join(f, face_of.try_emplace(v, f).first->second);
    edges.clear();
    for (const std::uint32_t f : patch) {
      std::array<Corner, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = set.soup.faces()[f][k];
        const Vec3& p = set.soup.positions()[v];
        const Vec2& uv = set.soup.uvs()[v];
        corners[k] = {p.x(), p.y(), p.z(), uv.x(), uv.y()};
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner &a = corners[k], &b = corners[(k + 1) % 3];
        // Zero-length edges at a pole would join unrelated triangles.
        if (!std::equal(a.begin(), a.begin() + 3, b.begin())) edges.push_back({{std::min(a, b), std::max(a, b)}, f});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.ends < b.ends; });
    for (std::size_t k = 1; k < edges.size(); ++k)
      if (edges[k].ends == edges[k - 1].ends) surfaces.join(edges[k].face, edges[k - 1].face);
  }
  std::vector<std::size_t> result(found.of_face.size());
  for (std::uint32_t f = 0; f < result.size(); ++f) result[f] = surfaces.root(f);
  return result;
}

// Shelf packing of the patches into the grid.
void place(std::vector<Patch>& patches, LightChart& chart) {
  std::uint64_t area = 0;
  int widest = 1;
  for (const Patch& patch : patches) {
    area += static_cast<std::uint64_t>(patch.columns) * static_cast<std::uint64_t>(patch.rows);
    widest = std::max(widest, patch.columns);
  }
  chart.width = std::max(widest, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(area)))));
  ShelfPacker packer(chart.width, std::numeric_limits<int>::max());
  for (Patch& patch : patches) {
    const ShelfPacker::Place place = packer.add(patch.columns, patch.rows);
    patch.left = place.x;
    patch.top = place.y;
  }
  chart.height = std::max(1, packer.pages().front().height);
}

// Barycentric weights of `at`, clamped into the triangle. `outside`: the largest clamped amount.
Vec3 nearest_weights(const std::array<Vec2, 3>& corners, const Vec2& at, double& outside) {
  Vec3 w = barycentric(corners, at);
  outside = std::max(0.0, -w.minCoeff());
  w = w.cwiseMax(0.0);
  return w / w.sum();
}

bool any_opaque(const FeatureTexture& texels, const TexelRect& rect, double x, double y, double reach_x,
                double reach_y) {
  const int left = std::max(rect.left, static_cast<int>(std::floor(x - reach_x))),
            right = std::min(rect.right, static_cast<int>(std::ceil(x + reach_x))),
            top = std::max(rect.top, static_cast<int>(std::floor(y - reach_y))),
            bottom = std::min(rect.bottom, static_cast<int>(std::ceil(y + reach_y)));
  for (int row = top; row <= bottom; ++row)
    for (int column = left; column <= right; ++column)
      if (texels.opaque(column, row)) return true;
  return false;
}

}  // namespace

LightChart light_chart(const TextureSet& set, double spacing) {
  const TexelPatches found = texel_patches(set);
  std::vector<Patch> patches;
  const auto nodes = [&](int texels) { return std::max(2, 1 + static_cast<int>(std::ceil((texels - 1) / spacing))); };
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;  // (patch of texels, surface) → index in `patches`
  const std::vector<std::size_t> surfaces = surfaces_of(set, found);
  for (std::uint32_t f = 0; f < found.of_face.size(); ++f) {
    const auto [it, fresh] = known.try_emplace({found.of_face[f], surfaces[f]}, patches.size());
    const TexelRect rect = texel_rect(set, set.soup.faces()[f]);
    if (fresh) patches.push_back({rect, 0, 0, 0, 0, {}});
    patches[it->second].rect.join(rect);
    patches[it->second].faces.push_back(f);
  }
  for (Patch& patch : patches) {
    patch.columns = nodes(patch.rect.width());
    patch.rows = nodes(patch.rect.height());
  }

  LightChart chart;
  chart.uvs = set.soup.shared_uvs();
  place(patches, chart);
  chart.places.resize(set.soup.positions().size(), Eigen::Vector2f::Zero());
  for (const Patch& patch : patches) {
    std::vector<std::array<Vec2, 3>> corners;
    for (const std::uint32_t f : patch.faces) {
      corners.push_back(texel_corners(set, f));
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2& t = corners.back()[k];
        chart.places[set.soup.faces()[f][k]] = {
            static_cast<float>(patch.left + 0.5 + (t.x() - patch.rect.left) / patch.step_x()),
            static_cast<float>(patch.top + 0.5 + (t.y() - patch.rect.top) / patch.step_y())};
      }
    }
    for (int row = 0; row < patch.rows; ++row)
      for (int column = 0; column < patch.columns; ++column) {
        const Vec2 at(patch.rect.left + column * patch.step_x(), patch.rect.top + row * patch.step_y());
        if (!any_opaque(*set.texels, patch.rect, at.x(), at.y(), patch.step_x(), patch.step_y())) continue;
        double least = std::numeric_limits<double>::infinity();
        LightChart::Node node{static_cast<std::uint32_t>((patch.top + row) * chart.width + patch.left + column),
                              0,
                              {},
                              static_cast<std::uint32_t>(&patch - patches.data())};
        for (std::size_t k = 0; k < corners.size() && least > 0; ++k) {
          double outside = 0;
          const Vec3 weights = nearest_weights(corners[k], at, outside);
          if (!(outside < least)) continue;
          least = outside;
          node.face = patch.faces[k];
          node.weights = weights.cast<float>();
        }
        if (least == std::numeric_limits<double>::infinity()) continue;
        chart.nodes.push_back(node);
      }
  }
  return chart;
}

}  // namespace rebake
