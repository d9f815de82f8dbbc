#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh_ops/light/proxy_mesh.h"

namespace rebake {

/// A mesh cut open to a disk and laid out on the unit square.
struct DiskChart {
  std::vector<std::uint32_t> source;  ///< of each vertex of the disk, the mesh's that it is a copy of
  std::vector<Vec2> uvs;              ///< of each, 0 … 1; the disk's border is the square's
  std::vector<Face> faces;            ///< of its vertices, in the mesh's order
};

/// A surface as an image (Gu, Gortler and Hoppe 2002): each texel is a point of it. Texels' centres lie on the square's
/// border, too.
class GeometryImage {
 public:
  GeometryImage(const DiskChart& chart, int side);

  struct Texel {
    std::array<std::uint32_t, 3> vertices;  ///< of the mesh
    Eigen::Vector3f weights;
  };
  int side() const { return side_; }
  const DiskChart& chart() const { return chart_; }
  const std::vector<Texel>& texels() const { return texels_; }
  /// What bilinear interpolation between texels gives each of the mesh's vertices: `channels` planes of side², to
  /// [vertex][channel].
  Eigen::VectorXf at_vertices(std::span<const float> planes, int channels) const;
  /// Share of the surface whose texels are larger there than twice what an even spread would give.
  double undersampled(const ProxyMesh& mesh) const;

 private:
  int side_;
  DiskChart chart_;
  std::vector<Texel> texels_;
  std::vector<Vec2> places_;  ///< of each of the mesh's vertices, one of its copies'
};

/// The chart of a mesh that is a regular grid of `side`² vertices, row by row.
DiskChart grid_chart(int side);

}  // namespace rebake
