#include "mesh_ops/fill/patch_texture.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh_ops/base/shelf_packer.h"

namespace rebake {

namespace {

constexpr int widest_page = 4096, highest_page = 16384, widest_cell = 64;

// Sum of 1 / length per edge of the patch; an edge of two triangles counts twice.
std::vector<Eigen::Triplet<double>> edge_weights(const HolePatch& patch) {
  std::vector<Eigen::Triplet<double>> weights;
  for (const Face& face : patch.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % 3];
      const double length = (patch.vertices[a] - patch.vertices[b]).norm();
      if (!(length > 0)) continue;
      weights.emplace_back(static_cast<int>(a), static_cast<int>(b), 1 / length);
    }
  return weights;
}

}  // namespace

PatchFeatures harmonic_features(const HolePatch& patch,
                                const std::vector<std::optional<std::array<double, 8>>>& border) {
  std::vector<int> unknown(patch.vertices.size(), -1);
  int count = 0;
  bool any = false;
  for (std::size_t v = 0; v < unknown.size(); ++v) {
    const bool known = v < border.size() && border[v];
    any = any || known;
    if (!known) unknown[v] = count++;
  }
  if (!any) return {};
  PatchFeatures features(patch.vertices.size());
  for (std::size_t v = 0; v < border.size(); ++v)
    if (border[v]) features[v] = *border[v];
  if (count == 0) return features;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 8);
  const auto add = [&](int a, int b, double weight) {
    const auto from = static_cast<std::size_t>(a), to = static_cast<std::size_t>(b);
    if (unknown[from] < 0) return;
    entries.emplace_back(unknown[from], unknown[from], weight);
    if (unknown[to] >= 0)
      entries.emplace_back(unknown[from], unknown[to], -weight);
    else
      for (std::size_t c = 0; c < 8; ++c)
        right(unknown[from], static_cast<Eigen::Index>(c)) += weight * features[to][c];
  };
  for (const auto& edge : edge_weights(patch)) {
    add(edge.row(), edge.col(), edge.value());
    add(edge.col(), edge.row(), edge.value());
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return {};
  const Eigen::MatrixXd solved = solver.solve(right);
  if (!solved.allFinite()) return {};
  for (std::size_t v = 0; v < unknown.size(); ++v)
    for (std::size_t c = 0; unknown[v] >= 0 && c < 8; ++c)
      features[v][c] = solved(unknown[v], static_cast<Eigen::Index>(c));
  return features;
}

namespace {

// The square of texels of a triangle of a patch, of which it takes half.
struct Cell {
  std::size_t patch, face;
  int side, x, y;
};
struct Cells {
  std::vector<Cell> cells;
  int width = 0;
  std::vector<ShelfPacker::Page> pages;
};

Cells packed_cells(const std::vector<HolePatch>& patches, double texel) {
  Cells result;
  std::vector<Cell>& cells = result.cells;
  for (std::size_t p = 0; p < patches.size(); ++p)
    for (std::size_t f = 0; f < patches[p].faces.size(); ++f) {
      const auto& v = patches[p].vertices;
      const Face& face = patches[p].faces[f];
      const double longest = std::max(
          {(v[face[1]] - v[face[0]]).norm(), (v[face[2]] - v[face[1]]).norm(), (v[face[0]] - v[face[2]]).norm()});
      const double texels = std::clamp(std::ceil(longest / texel), 1.0, widest_cell - 1.0);
      cells.push_back({p, f, static_cast<int>(texels) + 1, 0, 0});
    }
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.side > b.side; });
  double area = 0;
  for (const Cell& cell : cells) area += static_cast<double>(cell.side) * cell.side;
  result.width = std::clamp(static_cast<int>(std::ceil(std::sqrt(area))), widest_cell, widest_page);
  ShelfPacker packer(result.width, highest_page);
  for (Cell& cell : cells) {
    const ShelfPacker::Place place = packer.add(cell.side, cell.side);
    cell.x = place.x;
    cell.y = place.y;
  }
  result.pages = packer.pages();
  return result;
}

}  // namespace

TextureSet textured_patches(const std::vector<HolePatch>& patches, const std::vector<PatchFeatures>& features,
                            double texel, AlphaCode code, std::vector<std::size_t>& patch_of) {
  Cells packed = packed_cells(patches, texel);
  // All in one texture: larger texels if it would be too high.
  for (double larger = texel; packed.pages.size() > 1;) packed = packed_cells(patches, larger *= std::numbers::sqrt2);
  const std::vector<Cell>& cells = packed.cells;
  const int width = packed.width, height = packed.pages.front().height;
  // Unused texels repeat the first feature vector, because some formats have no holes.
  const auto bytes_of = [](const std::array<double, 8>& values) {
    Texel made;
    for (std::size_t c = 0; c < 8; ++c)
      (c < 4 ? made.feat0 : made.feat1)[c % 4] =
          static_cast<std::uint8_t>(std::clamp(std::lround(values[c]), c == 0 ? 1L : 0L, 255L));
    return made;
  };
  std::vector<Texel> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                            bytes_of(features.front().front()));
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  for (const Cell& cell : cells) {
    const Face& face = patches[cell.patch].faces[cell.face];
    const int last = cell.side - 1;
    for (int y = 0; y < cell.side; ++y)
      for (int x = 0; x < cell.side; ++x) {
        double u = static_cast<double>(x) / last, v = static_cast<double>(y) / last;
        // The half beyond the long side repeats that side.
        if (const double sum = u + v; sum > 1) u /= sum, v /= sum;
        std::array<double, 8> value{};
        for (std::size_t c = 0; c < 8; ++c)
          value[c] = (1 - u - v) * features[cell.patch][face[0]][c] + u * features[cell.patch][face[1]][c] +
                     v * features[cell.patch][face[2]][c];
        texels[static_cast<std::size_t>(cell.y + y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(cell.x + x)] = bytes_of(value);
      }
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const std::uint32_t vertex : face) positions.push_back(patches[cell.patch].vertices[vertex]);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(last, 0), std::pair(0, last)})
      uvs.emplace_back((cell.x + x + 0.5) / width, 1 - (cell.y + y + 0.5) / height);
    faces.push_back({first, first + 1, first + 2});
    patch_of.push_back(cell.patch);
  }
  const FeatureTexture texture = FeatureTexture::from_rows(width, height, code, [&](int y, Texel* row) {
    std::copy_n(&texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)], width, row);
  });
  return {Soup(std::move(positions), std::move(uvs), std::move(faces)),
          std::make_shared<const FeatureTexture>(texture)};
}

}  // namespace rebake
