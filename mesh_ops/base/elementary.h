#pragma once

#include <cmath>
#include <cstdint>

// Arctangent, exponential function, logarithm, sine and cosine of doubles from basic arithmetic only, so that edits
// commit the same bits on every processor: C libraries choose implementations by processor, and their last bits differ.
// Errors are at most 2 units in the last place. atan2() and atan() have no branches that prevent vectorisation. They
// are always inlined, so that files compiled for newer processors share no code with others.

namespace rebake::elementary {

/// Angle of (x, y) in radians, −π … π. Coefficients: Moshier, Cephes Mathematical Library (1989), atan.
[[gnu::always_inline]] inline double atan2(double y, double x) {
  constexpr double half_pi = 1.57079632679489661923, half_pi_rest = 6.123233995736765886130e-17;
  const double height = y < 0 ? -y : y, width = x < 0 ? -x : x;
  const bool steep = height > width;
  const double small = steep ? width : height, large = steep ? height : width;
  // tan(a − π/4) = (t − 1) / (t + 1) keeps the argument of the rational approximation within ±0.66.
  const bool middle = small > 0.66 * large;
  const double numerator = middle ? small - large : small, denominator = middle ? small + large : large;
  const double t = numerator / (denominator > 0 ? denominator : 1);
  const double z = t * t;
  const double p =
      (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
       1.228866684490136173410e2) *
          z -
      6.485021904942025371773e1;
  const double q =
      ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
       4.853903996359136964868e2) *
          z +
      1.945506571482613964425e2;
  const double rest = t + t * (z * p / q);
  const double low = middle ? half_pi / 2 + (rest + half_pi_rest / 2) : rest;
  const double quarter = steep ? half_pi - (low - half_pi_rest) : low;
  const double half = x < 0 ? 2 * half_pi - (quarter - 2 * half_pi_rest) : quarter;
  return y < 0 ? -half : half;
}

[[gnu::always_inline]] inline double atan(double x) { return atan2(x, 1.0); }

/// Natural logarithm of a positive, normal number. Coefficients: Sun Microsystems, fdlibm (1993), e_log.
inline double log(double x) {
  int exponent = 0;
  double fraction = std::frexp(x, &exponent);
  if (fraction < 0.70710678118654752440) {
    fraction *= 2;
    --exponent;
  }
  const double f = fraction - 1, s = f / (2 + f), z = s * s, w = z * z, k = exponent;
  const double odd = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const double even =
      z * (6.666666666666735130e-01 +
           w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const double square = 0.5 * f * f;
  return k * 6.93147180369123816490e-01 - ((square - (s * (square + odd + even) + k * 1.90821492927058770002e-10)) - f);
}

/// Exponential function; 0 below −745, infinity above 710. Coefficients and ln 2 in two parts: fdlibm (1993), e_exp.
inline double exp(double x) {
  if (!(x < 710)) return x < 0 || x > 0 ? HUGE_VAL : x;  // also NaN
  if (x < -745.2) return 0;
  const double k = std::nearbyint(x * 1.44269504088896338700);
  const double high = x - k * 6.93147180369123816490e-01, low = k * 1.90821492927058770002e-10;
  const double r = high - low, t = r * r;
  const double c =
      r -
      t * (1.66666666666666019037e-01 +
           t * (-2.77777777770155933842e-03 +
                t * (6.61375632143793436117e-05 + t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
  return std::ldexp(1 - ((low - (r * c) / (2 - c)) - high), static_cast<int>(k));
}

struct SineCosine {
  double sine, cosine;
};

/// Sine and cosine of an angle in radians; calls the C library beyond ±1e6. Coefficients and π/2 in three parts: fdlibm
/// (1993), k_sin, k_cos, e_rem_pio2.
inline SineCosine sine_cosine(double angle) {
  if (!(std::abs(angle) <= 1e6)) return {std::sin(angle), std::cos(angle)};
  const double turns = std::nearbyint(angle * 6.36619772367581382433e-01);
  // Cody–Waite argument reduction: the first two products are exact, and `tail` restores the rounding error of the
  // differences.
  double r = angle - turns * 1.57079632673412561417e+00;
  const double second = turns * 6.07710050630396597660e-11, before = r;
  r = before - second;
  const double lost = turns * 2.02226624879595063154e-21 - ((before - r) - second);
  const double x = r - lost, tail = (r - x) - lost;
  const double z = x * x;
  const double s =
      8.33333333332248946124e-03 +
      z * (-1.98412698298579493134e-04 +
           z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  const double c = z * (4.16666666666666019037e-02 +
                        z * (-1.38888888888741095749e-03 +
                             z * (2.48015872894767294178e-05 +
                                  z * (-2.75573143513906633035e-07 +
                                       z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const double cube = z * x;
  const double sine = x - ((z * (0.5 * tail - cube * s) - tail) - cube * -1.66666666666666324348e-01);
  const double half = 0.5 * z, most = 1 - half;
  const double cosine = most + (((1 - most) - half) + (z * c - x * tail));
  switch (static_cast<std::int64_t>(turns) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

}  // namespace rebake::elementary
