#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "editor/studies/dprt/dprt_measure.h"

namespace rebake {

/// Radiance from a direction: a sky with two soft lamps.
Radiance glossy_surroundings(const Vec3& direction);

/// Light per texel that a glossy surface reflects towards an eye: the dot product with a transfer (visibility × cosine,
/// 16 coefficients) is radiance. glossy_surroundings() are seen through a lobe cos¹⁶ about the direction of
/// reflection (modified Phong: Lafortune and Willems 1994), by 2048 directions. Red, green, blue.
std::vector<std::array<sh::Coefficients, 3>> glossy_light(const std::vector<LightSite>& sites, const Vec3& eye);

/// Radiance per texel for a transfer [16][texel].
std::vector<Radiance> reflected(const std::vector<std::array<sh::Coefficients, 3>>& light,
                                const std::vector<float>& transfer);

/// Errors of methods on glossy reflections towards the eye of their pictures, on some of the test frames.
class GlossyTest {
 public:
  /// `tests` must outlive this object.
  GlossyTest(const TracedFrames& traced, const std::vector<TestFrame>& tests);
  /// Root mean square error of radiance in percent of its root mean square.
  double percent_off(const DprtMethod& method) const;

 private:
  struct Lit {
    const TestFrame* frame;
    std::vector<std::array<sh::Coefficients, 3>> light;
    std::vector<Radiance> truth;
  };
  std::vector<Lit> frames_;
};

}  // namespace rebake
