#pragma once

#include <boost/math/quadrature/gauss.hpp>
#include <vector>

#include "mesh_ops/deform/cage_coordinates/plane_local.h"

// Integrals over a triangle that is thin or small compared with its distance from the point. There, closed forms
// subtract the contributions of the edges, which are far larger than their difference: the weights of a needle are off
// by rounding times its length over its height. Gauss-Legendre sums have terms of one sign and do not cancel.

namespace rebake::plane_local {

/// Whether a triangle is so thin that closed forms lose more than a digit.
inline bool is_needle(const FaceFrame& face) { return 16 * face.height < face.length; }

/// Distances, in extents of the face, from which quadrature is exact to rounding: with few nodes and with many. Between
/// the two, closed forms lose up to three digits but take a tenth of the time.
inline constexpr double few_nodes_from = 8, many_nodes_from = 1.5;

template <class T>
double distance_in_extents(const FaceFrame& face, const Seen<T>& s) {
  return std::hypot(value_of(s.h), distance_in_plane(s)) / (is_needle(face) ? face.height : face.length);
}

/// A quadrature node: barycentric coordinates, and its share of the area.
struct TriangleNode {
  double share;
  std::array<double, 3> lambda;
};

/// Gauss-Legendre nodes on a square collapsed to the triangle at corner 0 (Duffy): n nodes along and n across.
template <int n>
const std::vector<TriangleNode>& triangle_nodes() {
  static const std::vector<TriangleNode> nodes = [] {
    using Rule = boost::math::quadrature::gauss<double, n>;
    // On [0, 1]; Boost lists the nodes ≥ 0 of [−1, 1] only.
    std::vector<std::array<double, 2>> line;  // position, weight
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (const double sign : {1.0, -1.0})
        if (sign > 0 || Rule::abscissa()[k] != 0)
          line.push_back({(1 + sign * Rule::abscissa()[k]) / 2, Rule::weights()[k] / 2});
    std::vector<TriangleNode> result;
    for (const auto& [u, weight_u] : line)
      for (const auto& [v, weight_v] : line)
        result.push_back({2 * u * weight_u * weight_v, {1 - u, u * (1 - v), u * v}});
    return result;
  }();
  return nodes;
}

/// Calls f(dA, λ, r²) at the nodes of a triangle. The nearest pole of 1 / r is so far away that the remainder is below
/// 1e-17 of the sum.
template <bool many, class T, class F>
void for_each_triangle_node(const FaceFrame& face, const Seen<T>& s, const F& f) {
  const double area = face.length * face.height / 2;
  const T square_of_height = s.h * s.h;
  for (const TriangleNode& node : triangle_nodes<many ? 15 : 7>()) {
    T along = constant<T>(node.lambda[0]) * s.along[0], out = constant<T>(node.lambda[0]) * s.out[0];
    for (std::size_t k = 1; k < 3; ++k) {
      along += constant<T>(node.lambda[k]) * s.along[k];
      out += constant<T>(node.lambda[k]) * s.out[k];
    }
    f(node.share * area, node.lambda, along * along + out * out + square_of_height);
  }
}

/// Calls f(dA, λ, r²) at the nodes of a needle. On each side of corner 0's foot on the longest edge, the edge is cut
/// into pieces no longer than half their distance from the point. Each piece has 10 (15) nodes along the edge and 7
/// (15) across it. The nearest pole of 1 / r is then so far away that the remainder is below 1e-17 of the sum.
template <bool many, class T, class F>
void for_each_needle_node(const FaceFrame& face, const Seen<T>& s, const F& f) {
  using Across = boost::math::quadrature::gauss<double, many ? 15 : 7>;
  using Along = boost::math::quadrature::gauss<double, many ? 15 : 10>;
  // On [0, 1]; Boost lists the nodes ≥ 0 of [−1, 1] only.
  const auto for_each_of = [](const auto& places, const auto& weights, const auto& g) {
    for (std::size_t k = 0; k < places.size(); ++k) {
      g((1 + places[k]) / 2, weights[k] / 2);
      if (places[k] != 0) g((1 - places[k]) / 2, weights[k] / 2);
    }
  };
  const double beside = std::hypot(value_of(s.out[1]), value_of(s.h));
  for (const std::size_t corner : {std::size_t{1}, std::size_t{2}}) {  // each side runs from this corner to the foot
    const double reach = corner == 1 ? face.apex : face.length - face.apex;
    const double direction = corner == 1 ? 1 : -1;
    if (!(reach > 0)) continue;
    const double start = direction * value_of(s.along[corner]);
    for (double begin = 0; begin < 1;) {
      double size = 1 - begin;
      const auto too_long = [&] {
        const double low = start + begin * reach, high = low + size * reach;
        return 2 * size * reach > std::hypot(beside, std::max({0.0, low, -high}));
      };
      // Callers pass no point on the edge itself, but for one the loop must end too.
      while (too_long() && size > std::numeric_limits<double>::epsilon()) size /= 2;
      for_each_of(Along::abscissa(), Along::weights(), [&](double place, double weight_along) {
        const double u = begin + size * place, share = u * reach / face.length;
        const T e = s.along[corner] + constant<T>(direction * u * reach);
        const T square = e * e + s.h * s.h;
        for_each_of(Across::abscissa(), Across::weights(), [&](double v, double weight_across) {
          std::array<double, 3> lambda;
          lambda[0] = v * u;
          lambda[3 - corner] = share * (1 - v);
          lambda[corner] = 1 - lambda[0] - lambda[3 - corner];
          const T out = s.out[corner] - constant<T>(lambda[0] * face.height);
          f(weight_along * weight_across * size * reach * u * face.height, lambda, square + out * out);
        });
      });
      begin += size;
    }
  }
}

template <bool many, class T, class F>
void for_each_node(const FaceFrame& face, const Seen<T>& s, const F& f) {
  if (is_needle(face))
    for_each_needle_node<many>(face, s, f);
  else
    for_each_triangle_node<many>(face, s, f);
}

/// h ∫ λᵢ / r⁴ dA, by closed form or quadrature, whichever is accurate. `far_out`: the point is so far from the cage
/// that the sum over its faces cancels, so every digit counts.
template <class T>
std::array<T, 3> mean_value_terms(const FaceFrame& face, const Seen<T>& s, bool far_out = false) {
  const double distance = distance_in_extents(face, s);
  if (!(distance > (far_out ? many_nodes_from : few_nodes_from))) return mean_value(face, s);
  std::array<T, 3> sums{constant<T>(0), constant<T>(0), constant<T>(0)};
  const auto add = [&](double area, const std::array<double, 3>& lambda, const T& square) {
    const T share = constant<T>(area) / (square * square);
    for (std::size_t k = 0; k < 3; ++k) sums[k] += constant<T>(lambda[k]) * share;
  };
  if (distance > few_nodes_from)
    for_each_node<false>(face, s, add);
  else
    for_each_node<true>(face, s, add);
  for (T& sum : sums) sum = s.h * sum;
  return sums;
}

/// ∫ λᵢ h / r³ dA per corner and ∫ 1 / r dA, by closed form or quadrature, whichever is accurate.
template <class T>
GreenTerms<T> green_terms(const FaceFrame& face, const Seen<T>& s) {
  if (!(distance_in_extents(face, s) > few_nodes_from)) return green(face, s);
  GreenTerms<T> sums{{constant<T>(0), constant<T>(0), constant<T>(0)}, constant<T>(0)};
  for_each_node<false>(face, s, [&](double area, const std::array<double, 3>& lambda, const T& square) {
    const T by_r = constant<T>(area) / real::sqrt(square), by_cube = by_r / square;
    for (std::size_t k = 0; k < 3; ++k) sums.corners[k] += constant<T>(lambda[k]) * by_cube;
    sums.face += by_r;
  });
  for (T& corner : sums.corners) corner = s.h * corner;
  return sums;
}

}  // namespace rebake::plane_local
