// Compiled for several processor levels (mesh_ops/CMakeLists.txt); all give the same bits.
#include "mesh_ops/rays/covered_points.h"

#include <bit>
#include <cstring>
#include <limits>

#ifndef REBAKE_PARALLEL_NAME
#define REBAKE_PARALLEL_NAME parallel_kernels_baseline
#endif

#define REBAKE_INLINE [[gnu::always_inline]] inline

namespace rebake {

namespace {

#if defined(__AVX__)
constexpr std::size_t lanes = 8;
#else
constexpr std::size_t lanes = 4;
#endif
static_assert(lanes <= PointGrid::room);
using Floats = float __attribute__((vector_size(lanes * sizeof(float))));
using Integers = std::int32_t __attribute__((vector_size(lanes * sizeof(std::int32_t))));

REBAKE_INLINE Floats all(float value) { return Floats{} + value; }
REBAKE_INLINE Floats least(Floats a, Floats b) { return a < b ? a : b; }
REBAKE_INLINE Floats greatest(Floats a, Floats b) { return a > b ? a : b; }
template <class Vector, class Value>
REBAKE_INLINE Vector load(const Value* from) {
  Vector v;
  std::memcpy(&v, from, sizeof(v));
  return v;
}
template <class Vector, class Value>
REBAKE_INLINE void store(Vector v, Value* to) {
  std::memcpy(to, &v, sizeof(v));
}
REBAKE_INLINE Integers bits(Floats v) { return __builtin_bit_cast(Integers, v); }
// Bit mask of the lanes whose sign bit is set.
REBAKE_INLINE unsigned signs(Integers v) {
#if defined(__AVX__)
  return static_cast<unsigned>(__builtin_ia32_movmskps256(__builtin_bit_cast(Floats, v)));
#elif defined(__SSE__)
  return static_cast<unsigned>(__builtin_ia32_movmskps(__builtin_bit_cast(Floats, v)));
#else
  unsigned result = 0;
  for (std::size_t k = 0; k < lanes; ++k) result |= static_cast<unsigned>(v[k] < 0) << k;
  return result;
#endif
}

// Exceeds the rounding error of the projected coordinates of points and triangles. Both are assigned to cells by the
// same rounded sums.
constexpr float rounding = 1e-6F;

// A triangle is narrow if twice its area is below this share of its squared longest edge. Rounding noise then decides
// its edge tests, even far along its line, so its bounding rectangle is tested too.
constexpr float narrow = 1e-4F;

template <bool endless, bool solid>
void mark_by(const CornerColumns& corners, std::size_t triangles, const LineAxes& axes, const PointGrid& grid,
             float reach, const OpacityQuery& opaque, std::int32_t* marks) {
  const auto along = [](const std::array<float, 3>& axis, Floats x, Floats y, Floats z) {
    return x * axis[0] + y * axis[1] + z * axis[2];
  };
  float on_line[9][lanes];  // u, v, w of three corners
  std::int32_t left[lanes], right[lanes], bottom[lanes], top[lanes];
  const auto beyond = static_cast<float>(grid.columns_of.size());
  // Clamps a part number to the valid range.
  const auto part = [&](Floats number) {
    return __builtin_convertvector(least(greatest(number, all(0)), all(beyond - 1)), Integers);
  };
  Integers lane_numbers;
  for (std::size_t k = 0; k < lanes; ++k) lane_numbers[k] = static_cast<std::int32_t>(k);
  // Local copies, because `marks` might alias the grid.
  const float *const points_u = grid.u.data(), *const points_v = grid.v.data(), *const points_w = grid.w.data();
  const std::int32_t* const points_along = grid.along.data();
  const std::uint32_t* const first = grid.first.data();
  const std::uint16_t *const columns_of = grid.columns_of.data(), *const rows_of = grid.rows_of.data();
  const std::size_t columns = grid.columns;
  for (std::size_t t = 0; t < triangles; t += lanes) {
    Floats u[3], v[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = load<Floats>(corners[3 * k] + t), y = load<Floats>(corners[3 * k + 1] + t),
                 z = load<Floats>(corners[3 * k + 2] + t);
      u[k] = along(axes.u, x, y, z);
      v[k] = along(axes.v, x, y, z);
      store(u[k], on_line[3 * k]);
      store(v[k], on_line[3 * k + 1]);
      store(along(axes.w, x, y, z), on_line[3 * k + 2]);
    }
    const auto from = [](const Floats* c) { return least(c[0], least(c[1], c[2])) - rounding; };
    const auto to = [](const Floats* c) { return greatest(c[0], greatest(c[1], c[2])) + rounding; };
    const Floats u0 = (from(u) - grid.u_from) * grid.u_scale, u1 = (to(u) - grid.u_from) * grid.u_scale,
                 v0 = (from(v) - grid.v_from) * grid.v_scale, v1 = (to(v) - grid.v_from) * grid.v_scale;
    // Comparisons with NaN are false, but a minimum can hide a NaN among its operands; the sum cannot.
    const Floats sum = u[0] + u[1] + u[2];
    const auto squared = [](Floats x, Floats y) { return x * x + y * y; };
    const Floats abu = u[1] - u[0], abv = v[1] - v[0], acu = u[2] - u[0], acv = v[2] - v[0],
                 turned = abu * acv - acu * abv,
                 longest = greatest(squared(abu, abv), greatest(squared(acu, acv), squared(acu - abu, acv - abv)));
    const Integers there = (u1 >= 0.F) & (v1 >= 0.F) & (u0 < beyond) & (v0 < beyond) & (sum == sum);
    const unsigned narrow_ones = signs(greatest(turned, -turned) < narrow * longest);
    unsigned asked = signs(there);
    if (asked == 0) continue;
    store(part(u0), left);
    store(part(u1), right);
    store(part(v0), bottom);
    store(part(v1), top);
    for (; asked != 0; asked &= asked - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(asked));
      const std::uint32_t first_column = columns_of[static_cast<std::size_t>(left[lane])],
                          end_column = columns_of[static_cast<std::size_t>(right[lane])] + 1U,
                          first_row = rows_of[static_cast<std::size_t>(bottom[lane])],
                          last_row = rows_of[static_cast<std::size_t>(top[lane])];
      const Floats ua = all(on_line[0][lane]), va = all(on_line[1][lane]), wa = all(on_line[2][lane]),
                   ub = all(on_line[3][lane]), vb = all(on_line[4][lane]), wb = all(on_line[5][lane]),
                   uc = all(on_line[6][lane]), vc = all(on_line[7][lane]), wc = all(on_line[8][lane]);
      const std::uint32_t* row = first + std::size_t{first_row} * columns;
      for (std::uint32_t r = first_row; r <= last_row; ++r, row += columns)
        for (std::uint32_t s = row[first_column], end = row[end_column]; s < end; s += lanes) {
          const auto pu = load<Floats>(points_u + s), pv = load<Floats>(points_v + s), pw = load<Floats>(points_w + s);
          const Floats au = ua - pu, bu = ub - pu, cu = uc - pu, av = va - pv, bv = vb - pv, cv = vc - pv;
          // Twice the signed areas of the point with each edge. Two triangles with a common edge get exactly opposite
          // values for it, so that no point slips between them.
          const Floats a = bu * cv - cu * bv, b = cu * av - au * cv, c = au * bv - bu * av;
          const Floats area = a + b + c;
          const Floats height = a * (wa - pw) + b * (wb - pw) + c * (wc - pw);
          // The sign bit is set if the triangle does not occlude the point. Lanes beyond `end` are masked out.
          const Integers behind = bits(height) ^ bits(area) ^ load<Integers>(points_along + s);
          Integers hidden = ((least(a, least(b, c)) >= 0.F) | (greatest(a, greatest(b, c)) <= 0.F)) & (area != 0.F) &
                            ~behind & (lane_numbers < static_cast<std::int32_t>(end - s));
          if ((narrow_ones >> lane & 1) != 0) {
            const auto reaches = [](Floats p, Floats x, Floats y, Floats z) {
              return (p >= least(x, least(y, z)) - rounding) & (p <= greatest(x, greatest(y, z)) + rounding);
            };
            hidden &= reaches(pu, ua, ub, uc) & reaches(pv, va, vb, vc);
          }
          if constexpr (!endless) {
            const Floats far = reach * area;
            hidden &= ((height <= far) & (height >= -far)) | ((height >= far) & (height <= -far));
          }
          unsigned found = signs(hidden);
          if (found == 0) continue;
          if constexpr (solid) {
            for (; found != 0; found &= found - 1) marks[s + static_cast<std::size_t>(std::countr_zero(found))] = -1;
            continue;
          }
          found &= ~signs(load<Integers>(marks + s));
          if (found == 0) continue;
          const Floats b1 = b / area, b2 = c / area;
          for (; found != 0; found &= found - 1) {
            const auto k = static_cast<std::size_t>(std::countr_zero(found));
            if (opaque.ask(opaque.of, static_cast<std::uint32_t>(t + lane), b1[k], b2[k])) marks[s + k] = -1;
          }
        }
    }
  }
}

void mark_covered(const CornerColumns& corners, std::size_t triangles, const LineAxes& axes, const PointGrid& grid,
                  float reach, const OpacityQuery& opaque, std::int32_t* marks) {
  const bool endless = reach > std::numeric_limits<float>::max(), solid = opaque.ask == nullptr;
  const auto mark = endless ? (solid ? mark_by<true, true> : mark_by<true, false>)
                            : (solid ? mark_by<false, true> : mark_by<false, false>);
  mark(corners, triangles, axes, grid, reach, opaque, marks);
}

void project_points(const std::array<const double*, 3>& points, std::size_t count,
                    const std::array<std::array<double, 4>, 3>& rows, const std::array<float*, 3>& to) {
  const double *const x = points[0], *const y = points[1], *const z = points[2];
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = rows[k][0], b = rows[k][1], c = rows[k][2], d = rows[k][3];
    float* const out = to[k];
    for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<float>(a * x[i] + b * y[i] + c * z[i] + d);
  }
}

}  // namespace

extern const ParallelKernels REBAKE_PARALLEL_NAME;
const ParallelKernels REBAKE_PARALLEL_NAME = {mark_covered, project_points};

}  // namespace rebake
