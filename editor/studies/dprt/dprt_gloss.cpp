#include "editor/studies/dprt/dprt_gloss.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "editor/studies/dprt/dprt_pictures.h"

namespace rebake {

namespace {

constexpr int direction_count = 2048, exponent = 16;

// Even directions over the sphere: a Fibonacci lattice (González 2010).
std::vector<Vec3> even_directions() {
  std::vector<Vec3> directions;
  for (int k = 0; k < direction_count; ++k) {
    const double z = 1 - (2.0 * k + 1) / direction_count, r = std::sqrt(1 - z * z),
                 angle = std::numbers::pi * (3 - std::sqrt(5.0)) * k;
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

}  // namespace

Radiance glossy_surroundings(const Vec3& direction) {
  const auto lamp = [&](const Vec3& towards, double sharpness) {
    return std::exp(sharpness * (direction.dot(towards.normalized()) - 1));
  };
  const double height = 0.5 + 0.5 * direction.y();
  return Radiance(0.12, 0.11, 0.1) * (1 - height) + Radiance(0.2, 0.26, 0.36) * height +
         Radiance(5, 4.4, 3.6) * lamp({0.7, 0.8, 0.9}, 12) + Radiance(1.2, 1.8, 2.6) * lamp({-1, 0.3, 0.5}, 12);
}

std::vector<std::array<sh::Coefficients, 3>> glossy_light(const std::vector<LightSite>& sites, const Vec3& eye) {
  struct From {
    Vec3 direction;
    Radiance light;
    sh::Coefficients basis;
  };
  static const std::vector<From> around = [] {
    std::vector<From> result;
    for (const Vec3& direction : even_directions())
      result.push_back({direction, glossy_surroundings(direction), sh::basis(direction)});
    return result;
  }();
  // Relative to 1/π, which transfers contain, times the solid angle of a direction.
  const double scale = (exponent + 2) / 2.0 * 4 * std::numbers::pi / direction_count;
  std::vector<std::array<sh::Coefficients, 3>> result(sites.size());
  tbb::parallel_for(std::size_t{0}, sites.size(), [&](std::size_t i) {
    result[i].fill(sh::Coefficients::Zero());
    const Vec3 to_eye = (eye - sites[i].position).normalized(), n = sites[i].normal;
    const Vec3 mirrored = 2 * n.dot(to_eye) * n - to_eye;
    for (const From& from : around) {
      const double cosine = from.direction.dot(mirrored);
      if (cosine <= 0) continue;
      const double lobe = scale * std::pow(cosine, exponent);
      for (std::size_t c = 0; c < 3; ++c) result[i][c] += lobe * from.light[static_cast<Eigen::Index>(c)] * from.basis;
    }
  });
  return result;
}

std::vector<Radiance> reflected(const std::vector<std::array<sh::Coefficients, 3>>& light,
                                const std::vector<float>& transfer) {
  const std::size_t texels = light.size();
  std::vector<Radiance> result(texels);
  for (std::size_t t = 0; t < texels; ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t k = 0; k < sh::count; ++k)
        sum += static_cast<double>(transfer[k * texels + t]) * light[t][c][static_cast<Eigen::Index>(k)];
      result[t][static_cast<Eigen::Index>(c)] = std::max(0.0, sum);
    }
  return result;
}

GlossyTest::GlossyTest(const TracedFrames& traced, const std::vector<TestFrame>& tests) {
  constexpr std::size_t looked_at = 5;
  const std::size_t step = std::max<std::size_t>(1, tests.size() / looked_at);
  for (std::size_t k = 0; k < tests.size() && frames_.size() < looked_at; k += step) {
    Lit lit{&tests[k], glossy_light(tests[k].sites.sites, eye_of_picture(traced, tests[k].places)), {}};
    lit.truth = reflected(lit.light, tests[k].truth);
    frames_.push_back(std::move(lit));
  }
}

double GlossyTest::percent_off(const DprtMethod& method) const {
  double off = 0, all = 0;
  for (const Lit& lit : frames_) {
    const std::vector<Radiance> found = reflected(lit.light, method.predict(lit.frame->sites, lit.frame->places));
    for (std::size_t t = 0; t < found.size(); ++t) {
      off += (found[t] - lit.truth[t]).squaredNorm();
      all += lit.truth[t].squaredNorm();
    }
  }
  return 100 * std::sqrt(off / all);
}

}  // namespace rebake
