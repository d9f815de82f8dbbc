#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh_ops/light/learned/proxy_mesh.h"

namespace rebake {

/// A mesh cut to a disk and parametrised over the unit square.
struct DiskChart {
  std::vector<std::uint32_t> source;  ///< per disk vertex: the mesh vertex that it copies
  std::vector<Vec2> uvs;              ///< per disk vertex, 0 … 1; the boundary of the disk is that of the square
  std::vector<Face> faces;            ///< indices of disk vertices, in the order of the mesh's faces
  bool mean_value = false;            ///< laid out by mean value weights, because harmonic ones would fold
};

/// Throws std::invalid_argument unless each of `vertices` mesh vertices has a place in the square, and all numbers are
/// in range.
void check_chart(const DiskChart& chart, std::size_t vertices);

/// A geometry image (Gu, Gortler and Hoppe 2002): each texel is a point of the surface. The outermost texel centres lie
/// on the boundary of the square.
class GeometryImage {
 public:
  /// `side`: texels per side.
  GeometryImage(const DiskChart& chart, int side);

  struct Texel {
    std::array<std::uint32_t, 3> vertices;  ///< indices of mesh vertices
    Eigen::Vector3f weights;                ///< barycentric weights of the vertices
  };
  int side() const { return side_; }
  const DiskChart& chart() const { return chart_; }
  const std::vector<Texel>& texels() const { return texels_; }
  /// Bilinear interpolation of texels at the mesh's vertices: from `channels` planes of side² values to
  /// [vertex][channel].
  Eigen::VectorXf at_vertices(std::span<const float> planes, int channels) const;
  /// Share of the surface whose texels are more than twice as large as under an even distribution.
  double undersampled(const ProxyMesh& mesh) const;

 private:
  int side_;
  DiskChart chart_;
  std::vector<Texel> texels_;
  std::vector<Vec2> places_;  ///< per mesh vertex: the UV of one of its copies, in texels
};

/// The chart of a regular grid of `side`² vertices in row-major order.
DiskChart grid_chart(int side);

}  // namespace rebake
