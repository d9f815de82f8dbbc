#include "mesh_ops/light/learned/geometry_image.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mesh_ops/index/footprint.h"

namespace rebake {

void check_chart(const DiskChart& chart, std::size_t vertices) {
  const auto all = [](const auto& values, auto holds) { return std::all_of(values.begin(), values.end(), holds); };
  const bool fits =
      chart.uvs.size() == chart.source.size() && !chart.source.empty() &&
      *std::max_element(chart.source.begin(), chart.source.end()) + std::size_t{1} == vertices &&
      all(chart.uvs,
          [](const Vec2& uv) { return uv.allFinite() && uv.minCoeff() >= -1e-9 && uv.maxCoeff() <= 1 + 1e-9; }) &&
      all(chart.faces,
          [&](const Face& face) { return all(face, [&](std::uint32_t v) { return v < chart.source.size(); }); });
  if (!fits) throw std::invalid_argument("the chart of a network's image does not match its vertices");
}

GeometryImage::GeometryImage(const DiskChart& chart, int side) : side_(side), chart_(chart) {
  const double last = side - 1;
  std::vector<double> outside(static_cast<std::size_t>(side) * static_cast<std::size_t>(side),
                              std::numeric_limits<double>::infinity());
  texels_.resize(outside.size(), {{0, 0, 0}, {1, 0, 0}});
  for (const Face& face : chart.faces) {
    const std::array<Vec2, 3> corners{last * chart.uvs[face[0]], last * chart.uvs[face[1]], last * chart.uvs[face[2]]};
    const Vec2 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]),
               high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    // Half a texel of margin: a texel centre that rounding leaves outside all triangles uses the nearest one.
    constexpr double room = 0.5;
    for (int y = std::max(0, static_cast<int>(std::ceil(low.y() - room)));
         y <= std::min(side - 1, static_cast<int>(std::floor(high.y() + room))); ++y)
      for (int x = std::max(0, static_cast<int>(std::ceil(low.x() - room)));
           x <= std::min(side - 1, static_cast<int>(std::floor(high.x() + room))); ++x) {
        Vec3 w = barycentric(corners, Vec2(x, y));
        if (!w.allFinite()) continue;
        const double off = std::max(0.0, -w.minCoeff());
        const auto k = static_cast<std::size_t>(y * side + x);
        if (!(off < outside[k])) continue;
        outside[k] = off;
        w = w.cwiseMax(0.0);
        texels_[k] = {{chart.source[face[0]], chart.source[face[1]], chart.source[face[2]]},
                      (w / w.sum()).cast<float>()};
      }
  }
  std::uint32_t vertices = 0;
  for (const std::uint32_t v : chart.source) vertices = std::max(vertices, v + 1);
  places_.resize(vertices, Vec2(0, 0));
  for (std::size_t k = 0; k < chart.source.size(); ++k) places_[chart.source[k]] = last * chart.uvs[k];
}

Eigen::VectorXf GeometryImage::at_vertices(std::span<const float> planes, int channels) const {
  const std::size_t texels = texels_.size();
  Eigen::VectorXf result(static_cast<Eigen::Index>(places_.size()) * channels);
  for (std::size_t v = 0; v < places_.size(); ++v) {
    const double x = std::clamp(places_[v].x(), 0.0, side_ - 1.0), y = std::clamp(places_[v].y(), 0.0, side_ - 1.0);
    const int left = std::min(static_cast<int>(x), side_ - 2), top = std::min(static_cast<int>(y), side_ - 2);
    const float right = static_cast<float>(x - left), down = static_cast<float>(y - top);
    const auto first = static_cast<std::size_t>(top * side_ + left);
    for (int c = 0; c < channels; ++c) {
      const float* plane = planes.data() + static_cast<std::size_t>(c) * texels + first;
      result[static_cast<Eigen::Index>(v) * channels + c] =
          std::lerp(std::lerp(plane[0], plane[1], right), std::lerp(plane[side_], plane[side_ + 1], right), down);
    }
  }
  return result;
}

double GeometryImage::undersampled(const ProxyMesh& mesh) const {
  double all = 0;
  std::vector<double> areas;
  for (const Face& face : chart_.faces) {
    const Vec3& a = mesh.vertices[chart_.source[face[0]]];
    areas.push_back(
        (mesh.vertices[chart_.source[face[1]]] - a).cross(mesh.vertices[chart_.source[face[2]]] - a).norm() / 2);
    all += areas.back();
  }
  double sparse = 0;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    const Face& face = chart_.faces[f];
    const Vec2 e = chart_.uvs[face[1]] - chart_.uvs[face[0]], g = chart_.uvs[face[2]] - chart_.uvs[face[0]];
    // Share of the unit square's area.
    const double share = std::abs(e.x() * g.y() - e.y() * g.x()) / 2;
    if (areas[f] > 2 * all * share) sparse += areas[f];
  }
  return all > 0 ? sparse / all : 0;
}

DiskChart grid_chart(int side) {
  DiskChart chart;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      chart.source.push_back(static_cast<std::uint32_t>(chart.source.size()));
      chart.uvs.emplace_back(column / (side - 1.0), row / (side - 1.0));
      if (row + 1 == side || column + 1 == side) continue;
      const auto a = static_cast<std::uint32_t>(row * side + column), b = a + static_cast<std::uint32_t>(side);
      chart.faces.push_back({a, a + 1, b + 1});
      chart.faces.push_back({a, b + 1, b});
    }
  return chart;
}

}  // namespace rebake
