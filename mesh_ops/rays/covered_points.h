#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rebake {

/// Triangles' corners, a coordinate after the other: [3 · corner + axis].
using CornerColumns = std::array<const float*, 9>;

/// Points seen along a line: across it (u, v) and along it (w), in cells that hold about as many each. Arrays go on for
/// `room` points that nothing covers.
struct PointGrid {
  static constexpr std::size_t room = 16;

  std::span<const float> u, v, w;
  std::span<const std::int32_t> along;        ///< 0: what lies at larger w hides them, −1: at smaller w
  std::span<const std::uint32_t> first;       ///< number of a cell's first point, row by row, and the end
  std::span<const std::uint16_t> columns_of;  ///< of equal parts of what u spans
  std::span<const std::uint16_t> rows_of;     ///< of as many parts of what v spans
  std::uint32_t columns = 0, rows = 0;
  float u_from = 0, v_from = 0, u_scale = 0, v_scale = 0;  ///< (u − u_from) · u_scale is the number of a part
};

/// The line, and two directions across it, of length 1.
struct LineAxes {
  std::array<float, 3> u, v, w;
};

/// Whether a triangle is there, at weights b₁ and b₂ of its second and third corner.
struct OpaqueAt {
  const void* of;
  bool (*ask)(const void* of, std::uint32_t triangle, float b1, float b2);  ///< null: it is everywhere
};

/// Sets marks[i] to −1 for points that a triangle hides within `reach` along the line; those of −1 are not asked for.
/// Shared edges hide whatever lies on them. Corners that are no numbers make a triangle that hides nothing.
using MarkCovered = void (*)(const CornerColumns& corners, std::size_t triangles, const LineAxes& axes,
                             const PointGrid& grid, float reach, const OpaqueAt& opaque, std::int32_t* marks);

/// u, v, w of points x, y, z: rows of a 3 × 4 matrix times them.
using ProjectPoints = void (*)(const std::array<const double*, 3>& points, std::size_t count,
                               const std::array<std::array<double, 4>, 3>& rows, const std::array<float*, 3>& to);

struct ParallelKernels {
  MarkCovered mark_covered;
  ProjectPoints project_points;
};
/// What this processor can run, the fastest first. They find the same, to the bit.
std::vector<const ParallelKernels*> all_parallel_kernels();

// One source, compiled once for each kind of processor.
extern const ParallelKernels parallel_kernels_baseline;
#ifdef REBAKE_WIDE_VECTORS
extern const ParallelKernels parallel_kernels_v3;
#endif

}  // namespace rebake
