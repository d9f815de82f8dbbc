// Mean value coordinates of batches of points: the forms of plane_local.h without branches, as loops over lanes that
// the compiler vectorises, with gradients derived by hand. Terms of an edge are computed once for all its faces. Cases
// in which rounding decides are left to plane_local.h.
#include "mesh_ops/deform/cage_coordinates/mean_value_batch.h"

#include <math.h>

#include "mesh_ops/base/elementary.h"

#ifndef REBAKE_BATCH_NAME
#define REBAKE_BATCH_NAME mean_value_batch_baseline
#endif
#define REBAKE_INLINE [[gnu::always_inline]] inline

namespace rebake {

namespace {

constexpr int lanes = static_cast<int>(batch_lanes);
// The batch leaves out faces nearer to the point than this (local units).
constexpr double near_distance = 2e-6;
// It also leaves out faces with an edge if the point lies beyond the edge's ends, and nearer to its line than this
// share of the distance from the nearer end.
constexpr double near_line = 1e-4;
// Ratio below which the angle of an edge is a series: see plane_local::EdgeSeries.
constexpr double series_ratio = 1.0 / 7;
// Ratio of the projection's distance beside a triangle to the point's height. Above it, the sum over the edges cancels
// and the other form takes over. That form also holds nearer, but costs three more arctangents.
constexpr double grazing_ratio = 16;
// Prevents division by zero in lanes whose result is multiplied by zero.
constexpr double tiny = 1e-60;

// One edge's part of the form for points beside a triangle: (φ − a θ / c) / h², and its derivatives. φ and θ are the
// angles that the edge subtends at the projection and at the point. a ≥ 0 and c are the distances of the projection and
// of the point from the edge's line. `square` is h². `begin` and `end` are the edge's ends along its line.
struct Part {
  double v, by_a, by_square, by_ends;
};
REBAKE_INLINE double part_value(double a, double square, double c, double begin, double end, double theta) {
  const double both = c + a;
  const double upper = square * end / (both * (a * c + end * end + tiny)),
               lower = square * begin / (both * (a * c + begin * begin + tiny));
  // Both angles are small here, so one arctangent of the difference is enough.
  return theta / (c * both) + elementary::atan2(upper - lower, 1 + upper * lower) / square;
}
REBAKE_INLINE Part part(double a, double square, double c, double begin, double end, double theta) {
  const double v = part_value(a, square, c, begin, end, theta);
  const double aa = a * a + tiny, cc = c * c;
  const double end_a = 1 / (aa + end * end), end_c = 1 / (cc + end * end), begin_a = 1 / (aa + begin * begin),
               begin_c = 1 / (cc + begin * begin);
  const double by_c = begin * begin_c - end * end_c;
  return {v,
          (begin * (cc + aa + begin * begin) * begin_a * begin_c - end * (cc + aa + end * end) * end_a * end_c -
           theta / c) /
              cc,
          -(v + a / (2 * cc) * (by_c - theta / c)) / square, a * (end_a * end_c - begin_a * begin_c)};
}

// The sign of a, 1 for 0: on an edge's line, beyond its ends, a part is 0 but its slope is not.
REBAKE_INLINE double sign_of(double a) { return a < 0 ? -1.0 : 1.0; }
REBAKE_INLINE double least(double a, double b) { return a < b ? a : b; }
REBAKE_INLINE double greatest(double a, double b) { return a > b ? a : b; }
// 1 if the point lies beyond the edge's ends and near its line, else 0.
REBAKE_INLINE double beside_line(double a, double square, double begin, double end) {
  const double nearer = least(fabs(begin), fabs(end));
  return begin * end > 0 && a * a + square < near_line * near_line * nearer * nearer ? 1.0 : 0.0;
}

template <bool gradients>
std::size_t compute_weights(const BatchCage& cage, const double* points, const double* start, double* workspace,
                            double* weights, double* slopes, SkippedFace* near) {
  constexpr int row = (gradients ? 4 : 1) * lanes;
  const double *px = points, *py = points + lanes, *pz = points + 2 * lanes;
  double* const angles = workspace;                      // per edge: θ / c, then its gradient; rows of lanes
  double* const sums = angles + cage.edge_count * row;   // per vertex: unnormalised weight and gradient
  double* const sizes = sums + cage.vertex_count * row;  // sums of the magnitudes of all terms: a row of lanes
  for (std::size_t i = 0; i < cage.vertex_count * row; ++i) sums[i] = start != nullptr ? start[i] : 0;
  for (int lane = 0; lane < lanes; ++lane) sizes[lane] = 0;

  for (std::size_t e = 0; e < cage.edge_count; ++e) {
    const double* frame = cage.edge_frames + 4 * e;
    const double* first = cage.vertices + 3 * static_cast<std::size_t>(cage.edges[2 * e]);
    const double tx = frame[0], ty = frame[1], tz = frame[2], length = frame[3];
    const double fx = first[0], fy = first[1], fz = first[2];
    double* q = angles + e * row;
#pragma omp simd
    for (int lane = 0; lane < lanes; ++lane) {
      const double ex = fx - px[lane], ey = fy - py[lane], ez = fz - pz[lane];
      const double begin = tx * ex + ty * ey + tz * ez, end = begin + length;
      // The distance from the line as a cross product avoids a difference of squares.
      const double cx = ey * tz - ez * ty, cy = ez * tx - ex * tz, cz = ex * ty - ey * tx;
      const double cc = cx * cx + cy * cy + cz * cz + tiny, c = sqrt(cc);
      const double theta = elementary::atan2(c * length, cc + begin * end);
      const double by_c = 1 / c, value = theta * by_c;
      q[lane] = value;
      if constexpr (gradients) {
        const double first_end = 1 / (cc + begin * begin), second_end = 1 / (cc + end * end);
        // ∇θ = ∂θ/∂c ∇c + ∂θ/∂begin ∇begin, where ∇c = −(e − begin t) / c and ∇begin = −t.
        const double closed = -(begin * first_end - end * second_end - value) * by_c * by_c;
        // −2 d(θ/c)/dc² by its series, used if the closed form is 0 / 0: Σ (−1)ⁿ⁺¹ 2n βₙ c²ⁿ⁻² / (2n + 1).
        const double nearer = least(fabs(begin), fabs(end));
        // A product of numbers, since a condition would become a branch and prevent vectorisation.
        const double beyond =
            (begin * end > 0 ? 1.0 : 0.0) * (cc < series_ratio * series_ratio * nearer * nearer ? 1.0 : 0.0);
        const double u = 1 / (beyond * begin + (1 - beyond)), v = 1 / (beyond * end + (1 - beyond));
        const double uu = u * u, vv = v * v, odd = v * (u + v);
        double powers = uu + odd, v_power = vv, term = length * u * v, series = 0;
        // Unrolled by hand: an inner loop would prevent vectorisation of the loop over lanes.
        const auto add = [&](double share) __attribute__((always_inline)) {
          series += term * powers * share;
          powers = powers * uu + v_power * odd;
          v_power = v_power * vv;
          term = -term * beyond * cc;
        };
        add(2.0 / 3);
        add(4.0 / 5);
        add(6.0 / 7);
        add(8.0 / 9);
        add(10.0 / 11);
        add(12.0 / 13);
        add(14.0 / 15);
        add(16.0 / 17);
        add(18.0 / 19);
        add(20.0 / 21);
        const double across = beyond * series + (1 - beyond) * closed;
        const double along = -(second_end - first_end) - across * begin;
        q[lanes + lane] = across * ex + along * tx;
        q[2 * lanes + lane] = across * ey + along * ty;
        q[3 * lanes + lane] = across * ez + along * tz;
      }
    }
  }

  std::size_t near_count = 0;
  for (std::size_t f = 0; f < cage.face_count; ++f) {
    const std::uint32_t* corners = cage.faces + 6 * f;
    const double *q0 = angles + static_cast<std::size_t>(corners[3]) * row,
                 *q1 = angles + static_cast<std::size_t>(corners[4]) * row,
                 *q2 = angles + static_cast<std::size_t>(corners[5]) * row;
    double *w0 = sums + static_cast<std::size_t>(corners[0]) * row,
           *w1 = sums + static_cast<std::size_t>(corners[1]) * row,
           *w2 = sums + static_cast<std::size_t>(corners[2]) * row;
    const double* v1 = cage.vertices + 3 * static_cast<std::size_t>(corners[1]);
    const double v1x = v1[0], v1y = v1[1], v1z = v1[2];
    const double* frame = cage.face_frames + batch_face_numbers * f;
    const double nx = frame[0], ny = frame[1], nz = frame[2], tx = frame[3], ty = frame[4], tz = frame[5],
                 ox = frame[6], oy = frame[7], oz = frame[8];
    const double length = frame[9], apex = frame[11], by_height = 1 / frame[10], by_length = 1 / length;
    const double et1 = frame[13], et2 = frame[14], eo1 = frame[16], eo2 = frame[17];
    const double nt1 = frame[19], nt2 = frame[20], no1 = frame[22], no2 = frame[23];
    const double length1 = frame[25], length2 = frame[26];
    const double beside_ratio = grazing_ratio * frame[27];
    double grazing[lanes], left_out[lanes];
    double near_lanes = 0, grazing_lanes = 0;
#pragma omp simd reduction(+ : near_lanes) reduction(+ : grazing_lanes)
    for (int lane = 0; lane < lanes; ++lane) {
      const double ex = v1x - px[lane], ey = v1y - py[lane], ez = v1z - pz[lane];
      const double h = nx * ex + ny * ey + nz * ez, along = tx * ex + ty * ey + tz * ez,
                   out = ox * ex + oy * ey + oz * ez;
      const double a1 = (along + length) * nt1 + out * no1, a2 = along * nt2 + out * no2;
      const double beside = -least(out, least(a1, a2));
      const double height = fabs(h);
      // Edge 0 begins at corner 1, edge 1 at corner 2; edge 2 ends at corner 1.
      const double far = along + length, begin1 = far * et1 + out * eo1, end2 = along * et2 + out * eo2;
      const double on = greatest(height, beside) < near_distance ? 1.0 : 0.0;
      const double beside_lines = beside_line(out, h * h, along, far) +
                                  beside_line(a1, h * h, begin1, begin1 + length1) +
                                  beside_line(a2, h * h, end2 - length2, end2);
      const double left = on > 0 ? 2.0 : beside_lines > 0 ? 1.0 : 0.0;
      left_out[lane] = left;
      near_lanes += left;
      const double grazes = beside > beside_ratio * height && left == 0 ? 1.0 : 0.0;
      grazing[lane] = grazes;
      grazing_lanes += grazes;
      const double kept = left == 0 ? 1.0 : 0.0;
      // Σ a θ / c / 2h², for lanes that do not graze.
      const double half = (1 - grazes) * 0.5 / (h * h + tiny);
      const double k0 = q0[lane], k1 = q1[lane], k2 = q2[lane];
      const double whole = (out * k0 + a1 * k1 + a2 * k2) * half;
      const double lambda0 = out * by_height;
      const double lambda2 = -((1 - lambda0) * along + lambda0 * (along + apex)) * by_length;
      const double lambda1 = 1 - lambda0 - lambda2;
      // ∇λ · Σ ν θ / c. The normal of edge 0 is `outward` itself.
      const double gt = k1 * nt1 + k2 * nt2, go = k0 + k1 * no1 + k2 * no2;
      const double slope0 = -go * by_height, slope2 = (gt - slope0 * apex) * by_length;
      const double slope1 = -(slope0 + slope2);
      const double part0 = lambda0 * whole - 0.5 * slope0, part1 = lambda1 * whole - 0.5 * slope1,
                   part2 = lambda2 * whole - 0.5 * slope2;
      // In its own plane, beside it, a face has value 0 but a gradient.
      const double below = height <= 1e-15 ? 0.0 : h;
      w0[lane] += kept > 0 ? below * part0 : 0.0;
      w1[lane] += kept > 0 ? below * part1 : 0.0;
      w2[lane] += kept > 0 ? below * part2 : 0.0;
      // The same sums with all terms positive: rounding errors are relative to these.
      const double along1 = fabs(k1 * nt1) + fabs(k2 * nt2), across1 = fabs(k0) + fabs(k1 * no1) + fabs(k2 * no2);
      const double whole_size = (fabs(out * k0) + fabs(a1 * k1) + fabs(a2 * k2)) * half;
      const double slope0_size = across1 * by_height, slope2_size = (along1 + slope0_size * fabs(apex)) * by_length;
      const double size = (fabs(lambda0) + fabs(lambda1) + fabs(lambda2)) * whole_size + slope0_size + slope2_size;
      sizes[lane] += kept > 0 ? fabs(below) * size : 0.0;
      if constexpr (gradients) {
        const double by_h = 2 * whole * h / (h * h + tiny);
        const auto axis = [&](int n, double normal, double tangent, double outward) __attribute__((always_inline)) {
          const double g0 = q0[n * lanes + lane], g1 = q1[n * lanes + lane], g2 = q2[n * lanes + lane];
          const double d1 = -(tangent * nt1 + outward * no1), d2 = -(tangent * nt2 + outward * no2);
          const double d_whole =
              (-outward * k0 + d1 * k1 + d2 * k2 + out * g0 + a1 * g1 + a2 * g2) * half + by_h * normal;
          const double d_lambda0 = -outward * by_height;
          const double d_lambda2 = (tangent - d_lambda0 * apex) * by_length, d_lambda1 = -(d_lambda0 + d_lambda2);
          const double dt = g1 * nt1 + g2 * nt2, d_o = g0 + g1 * no1 + g2 * no2;
          const double d_slope0 = -d_o * by_height, d_slope2 = (dt - d_slope0 * apex) * by_length;
          const double d_slope1 = -(d_slope0 + d_slope2);
          const double d_part0 = h * (d_lambda0 * whole + lambda0 * d_whole - 0.5 * d_slope0) - normal * part0;
          w0[n * lanes + lane] += kept > 0 ? d_part0 : 0.0;
          const double d_part1 = h * (d_lambda1 * whole + lambda1 * d_whole - 0.5 * d_slope1) - normal * part1;
          w1[n * lanes + lane] += kept > 0 ? d_part1 : 0.0;
          const double d_part2 = h * (d_lambda2 * whole + lambda2 * d_whole - 0.5 * d_slope2) - normal * part2;
          w2[n * lanes + lane] += kept > 0 ? d_part2 : 0.0;
        };
        axis(1, nx, tx, ox);
        axis(2, ny, ty, oy);
        axis(3, nz, tz, oz);
      }
    }
    if (near_lanes > 0)
      for (int lane = 0; lane < lanes; ++lane)
        if (left_out[lane] > 0)
          near[near_count++] = {static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(lane), left_out[lane] > 1};
    if (grazing_lanes > 0) {
#pragma omp simd
      for (int lane = 0; lane < lanes; ++lane) {
        const double ex = v1x - px[lane], ey = v1y - py[lane], ez = v1z - pz[lane];
        const double h = nx * ex + ny * ey + nz * ez, along = tx * ex + ty * ey + tz * ez,
                     out = ox * ex + oy * ey + oz * ez;
        const double far = along + length;
        const double a1 = far * nt1 + out * no1, a2 = along * nt2 + out * no2;
        const double begin1 = far * et1 + out * eo1, end2 = along * et2 + out * eo2;
        const double square = h * h + tiny;
        const double k0 = q0[lane], k1 = q1[lane], k2 = q2[lane];
        const double sign0 = sign_of(out), sign1 = sign_of(a1), sign2 = sign_of(a2);
        const double c0 = sqrt(out * out + square), c1 = sqrt(a1 * a1 + square), c2 = sqrt(a2 * a2 + square);
        const double lambda0 = out * by_height;
        const double lambda2 = -((1 - lambda0) * along + lambda0 * (along + apex)) * by_length;
        const double lambda1 = 1 - lambda0 - lambda2;
        const double below = fabs(h) <= 1e-15 ? 0.0 : h;
        const double lambdas = fabs(lambda0) + fabs(lambda1) + fabs(lambda2);
        if constexpr (!gradients) {
          const double value0 = part_value(sign0 * out, square, c0, along, far, k0 * c0),
                       value1 = part_value(sign1 * a1, square, c1, begin1, begin1 + length1, k1 * c1),
                       value2 = part_value(sign2 * a2, square, c2, end2 - length2, end2, k2 * c2);
          const double whole = -0.5 * (sign0 * value0 + sign1 * value1 + sign2 * value2);
          sizes[lane] += grazing[lane] > 0 ? fabs(below) * lambdas * (fabs(value0) + fabs(value1) + fabs(value2)) : 0.0;
          w0[lane] += grazing[lane] > 0 ? below * lambda0 * whole : 0.0;
          w1[lane] += grazing[lane] > 0 ? below * lambda1 * whole : 0.0;
          w2[lane] += grazing[lane] > 0 ? below * lambda2 * whole : 0.0;
        } else {
          const Part p0 = part(sign0 * out, square, c0, along, far, k0 * c0),
                     p1 = part(sign1 * a1, square, c1, begin1, begin1 + length1, k1 * c1),
                     p2 = part(sign2 * a2, square, c2, end2 - length2, end2, k2 * c2);
          constexpr double half = -0.5;
          const double whole = half * (sign0 * p0.v + sign1 * p1.v + sign2 * p2.v);
          sizes[lane] += grazing[lane] > 0 ? fabs(below) * lambdas * (fabs(p0.v) + fabs(p1.v) + fabs(p2.v)) : 0.0;
          w0[lane] += grazing[lane] > 0 ? below * lambda0 * whole : 0.0;
          w1[lane] += grazing[lane] > 0 ? below * lambda1 * whole : 0.0;
          w2[lane] += grazing[lane] > 0 ? below * lambda2 * whole : 0.0;
          const double by_height_of_point =
              -2 * h * half * (sign0 * p0.by_square + sign1 * p1.by_square + sign2 * p2.by_square);
          const auto axis = [&](int n, double normal, double tangent, double outward) __attribute__((always_inline)) {
            const double d1 = -(tangent * nt1 + outward * no1), d2 = -(tangent * nt2 + outward * no2);
            const double e1 = -(tangent * et1 + outward * eo1), e2 = -(tangent * et2 + outward * eo2);
            const double d_whole =
                by_height_of_point * normal +
                half * (-outward * p0.by_a + d1 * p1.by_a + d2 * p2.by_a - sign0 * tangent * p0.by_ends +
                        sign1 * e1 * p1.by_ends + sign2 * e2 * p2.by_ends);
            const double d_lambda0 = -outward * by_height;
            const double d_lambda2 = (tangent - d_lambda0 * apex) * by_length, d_lambda1 = -(d_lambda0 + d_lambda2);
            const double d_part0 = h * (d_lambda0 * whole + lambda0 * d_whole) - normal * lambda0 * whole;
            w0[n * lanes + lane] += grazing[lane] > 0 ? d_part0 : 0.0;
            const double d_part1 = h * (d_lambda1 * whole + lambda1 * d_whole) - normal * lambda1 * whole;
            w1[n * lanes + lane] += grazing[lane] > 0 ? d_part1 : 0.0;
            const double d_part2 = h * (d_lambda2 * whole + lambda2 * d_whole) - normal * lambda2 * whole;
            w2[n * lanes + lane] += grazing[lane] > 0 ? d_part2 : 0.0;
          };
          axis(1, nx, tx, ox);
          axis(2, ny, ty, oy);
          axis(3, nz, tz, oz);
        }
      }
    }
  }

  double total[row];
  for (int i = 0; i < row; ++i) total[i] = 0;
  for (std::size_t v = 0; v < cage.vertex_count; ++v)
    for (int i = 0; i < row; ++i) total[i] += sums[v * row + static_cast<std::size_t>(i)];
  for (std::size_t v = 0; v < cage.vertex_count; ++v) {
    const double* sum = sums + v * row;
    double* weight = weights + v * batch_lanes;
#pragma omp simd
    for (int lane = 0; lane < lanes; ++lane) weight[lane] = sum[lane] / total[lane];
    if constexpr (gradients) {
      double* slope = slopes + v * 3 * batch_lanes;
      for (int n = 1; n < 4; ++n)
#pragma omp simd
        for (int lane = 0; lane < lanes; ++lane)
          slope[(n - 1) * lanes + lane] =
              (sum[n * lanes + lane] - weight[lane] * total[n * lanes + lane]) / total[lane];
    }
  }
  return near_count;
}

}  // namespace

std::size_t REBAKE_BATCH_NAME(const BatchCage& cage, const double* points, const double* start, double* workspace,
                              double* weights, double* gradients, SkippedFace* near) {
  if (gradients != nullptr) return compute_weights<true>(cage, points, start, workspace, weights, gradients, near);
  return compute_weights<false>(cage, points, start, workspace, weights, gradients, near);
}

}  // namespace rebake
