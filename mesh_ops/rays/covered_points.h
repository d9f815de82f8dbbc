#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rebake {

/// Triangle corners as one array per coordinate: [3 · corner + axis][triangle].
using CornerColumns = std::array<const float*, 9>;

/// Points projected along a line, sorted into the cells of a 2D grid with about equal numbers of points. Coordinates
/// are u and v across the line and w along it. Arrays are padded with `room` NaN points, which no triangle covers.
struct PointGrid {
  static constexpr std::size_t room = 16;

  std::span<const float> u, v, w;
  std::span<const std::int32_t> along;   ///< per point: 0 if its ray goes to larger w, −1 if to smaller w
  std::span<const std::uint32_t> first;  ///< per cell, row-major: index of its first point; then the number of points
  std::span<const std::uint16_t> columns_of;  ///< grid column per part; the range of u is divided into equal parts
  std::span<const std::uint16_t> rows_of;     ///< grid row per part; v has as many parts as u
  std::uint32_t columns = 0, rows = 0;
  float u_from = 0, v_from = 0, u_scale = 0, v_scale = 0;  ///< part of u: (u − u_from) · u_scale; same for v
};

/// Orthogonal unit vectors: w along the line, u and v across it.
struct LineAxes {
  std::array<float, 3> u, v, w;
};

/// Opacity query for a point of a triangle, given by the barycentric weights b1 and b2 of its second and third corner.
struct OpacityQuery {
  const void* of;                                                           ///< first argument of `ask`
  bool (*ask)(const void* of, std::uint32_t triangle, float b1, float b2);  ///< null: opaque everywhere
};

/// Sets marks[i] to −1 for points that a triangle occludes within `reach` along the line; points already at −1 are
/// skipped. Watertight: points on a shared edge are covered. Triangles with a NaN corner cover nothing.
using MarkCovered = void (*)(const CornerColumns& corners, std::size_t triangles, const LineAxes& axes,
                             const PointGrid& grid, float reach, const OpacityQuery& opaque, std::int32_t* marks);

/// Projects `count` points (x, y, z arrays) to u, v, w with a 3 × 4 matrix, in double precision, rounded to float.
using ProjectPoints = void (*)(const std::array<const double*, 3>& points, std::size_t count,
                               const std::array<std::array<double, 4>, 3>& rows, const std::array<float*, 3>& to);

/// Function table of one implementation, for one processor level.
struct ParallelKernels {
  MarkCovered mark_covered;
  ProjectPoints project_points;
};
/// All implementations that this processor can run, fastest first. They give the same bits.
std::vector<const ParallelKernels*> all_parallel_kernels();

// Compiled from one source file for each processor level.
extern const ParallelKernels parallel_kernels_baseline;
#ifdef REBAKE_WIDE_VECTORS
extern const ParallelKernels parallel_kernels_v3;
#endif

}  // namespace rebake
