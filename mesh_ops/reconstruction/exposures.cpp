#include "mesh_ops/reconstruction/exposures.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/reconstruction/gradient_steps.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

void Exposures::add(std::size_t photograph, const Vec3& in_photograph, const Vec3& in_scene) {
  constexpr double bright = 0.98;
  if (in_photograph.maxCoeff() >= bright) return;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = static_cast<Eigen::Index>(c);
    const double own = to_linear(std::max(0.0, in_scene[at])), wanted = to_linear(in_photograph[at]);
    double* sums = &sums_[9 * photograph + 3 * c];
    sums[0] += own * wanted;
    sums[1] += own * own;
    sums[2] += wanted * wanted;
  }
}

std::vector<Vec3> Exposures::gains() const {
  const std::size_t count = sums_.size() / 9;
  std::vector<Vec3> gains(count, Vec3::Ones());
  Vec3 logs = Vec3::Zero();
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      const double* sums = &sums_[9 * k + 3 * c];
      const auto at = static_cast<Eigen::Index>(c);
      // Within five stops.
      if (sums[0] > 0 && sums[1] > 0) gains[k][at] = std::clamp(sums[0] / sums[1], 1.0 / 32, 32.0);
      logs[at] += std::log(gains[k][at]) / static_cast<double>(count);
    }
  for (Vec3& gain : gains) gain = gain.cwiseQuotient(logs.array().exp().matrix()).cwiseProduct(mean);
  return gains;
}

void Exposures::fade() {
  for (double& sum : sums_) sum /= 2;
}

bool Exposures::differ() const {
  constexpr double least_spread = 0.04, least_explained = 1.0 / 3;
  return spread() >= least_spread && explained() >= least_explained;
}

double Exposures::explained() const {
  double with_one = 0, with_each = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    double all[3] = {0, 0, 0};
    for (std::size_t k = 0; k < sums_.size() / 9; ++k) {
      const double* sums = &sums_[9 * k + 3 * c];
      for (std::size_t i = 0; i < 3; ++i) all[i] += sums[i];
      if (sums[1] > 0) with_each += sums[2] - sums[0] * sums[0] / sums[1];
    }
    if (all[1] > 0) with_one += all[2] - all[0] * all[0] / all[1];
  }
  return with_one > 0 ? 1 - with_each / with_one : 0;
}

double Exposures::spread() const {
  const std::vector<Vec3> all = gains();
  double middle = 0, squares = 0;
  for (const Vec3& gain : all) middle += gain.mean() / static_cast<double>(all.size());
  for (const Vec3& gain : all) squares += std::pow(gain.mean() / middle - 1, 2) / static_cast<double>(all.size());
  return std::sqrt(squares);
}

void Exposures::save(std::string& bytes) const { put_numbers(bytes, sums_); }

void Exposures::load(std::string_view& bytes) { take_numbers(bytes, sums_); }

}  // namespace rebake
