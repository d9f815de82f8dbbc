#include "mesh_ops/scene/scene_light.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rebake {

SkyMap::SkyMap(int side)
    : side_(side), texels_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), Eigen::Vector3f::Zero()) {}

SkyMap::SkyMap(const Radiance& uniform) : SkyMap(1) { texels_.front() = uniform.cast<float>(); }

Vec3 SkyMap::direction(std::size_t texel) const {
  const std::size_t side = static_cast<std::size_t>(side_), column = texel % side, row = texel / side;
  const double x = (static_cast<double>(column) + 0.5) / side_ * 2 - 1,
               y = (static_cast<double>(row) + 0.5) / side_ * 2 - 1;
  Vec3 d(x, 1 - std::abs(x) - std::abs(y), y);
  if (d.y() < 0) d = Vec3((1 - std::abs(y)) * (x >= 0 ? 1 : -1), d.y(), (1 - std::abs(x)) * (y >= 0 ? 1 : -1));
  return d.normalized();
}

Radiance SkyMap::at(const Vec3& direction) const {
  if (side_ == 1) return texels_.front().cast<double>();
  const double sum = direction.cwiseAbs().sum();
  double x = direction.x() / sum, y = direction.z() / sum;
  if (direction.y() < 0) {
    const double folded = (1 - std::abs(y)) * (x >= 0 ? 1 : -1);
    y = (1 - std::abs(x)) * (y >= 0 ? 1 : -1);
    x = folded;
  }
  const double column = std::clamp((x + 1) / 2 * side_ - 0.5, 0.0, side_ - 1.0),
               row = std::clamp((y + 1) / 2 * side_ - 0.5, 0.0, side_ - 1.0);
  const int i = std::min(static_cast<int>(column), side_ - 2), j = std::min(static_cast<int>(row), side_ - 2);
  const double fx = column - i, fy = row - j;
  const auto texel = [&](int a, int b) -> const Eigen::Vector3f& {
    return texels_[static_cast<std::size_t>(j + b) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(i + a)];
  };
  const auto weight = [](double w) { return static_cast<float>(w); };
  return (texel(0, 0) * weight((1 - fx) * (1 - fy)) + texel(1, 0) * weight(fx * (1 - fy)) +
          texel(0, 1) * weight((1 - fx) * fy) + texel(1, 1) * weight(fx * fy))
      .cast<double>();
}

SkyMap SkyMap::coarser(int factor) const {
  SkyMap result(side_ / factor);
  for (int y = 0; y < side_; ++y)
    for (int x = 0; x < side_; ++x)
      result.texels_[static_cast<std::size_t>(y / factor * result.side_ + x / factor)] +=
          texels_[static_cast<std::size_t>(y * side_ + x)] / static_cast<float>(factor * factor);
  return result;
}

SkyMap SkyMap::scaled(const Radiance& factors) const {
  SkyMap result = *this;
  for (Eigen::Vector3f& texel : result.texels_) texel = texel.cwiseProduct(factors.cast<float>());
  return result;
}

bool SkyMap::black() const {
  return std::all_of(texels_.begin(), texels_.end(), [](const Eigen::Vector3f& t) { return t.isZero(0); });
}

Radiance SkyMap::mean() const {
  // The solid angle of an octahedral texel is proportional to the cube of the 1-norm of its unit direction.
  Radiance sum = Radiance::Zero();
  double weights = 0;
  for (std::size_t k = 0; k < texels_.size(); ++k) {
    const double weight = std::pow(direction(k).cwiseAbs().sum(), 3);
    sum += weight * texels_[k].cast<double>();
    weights += weight;
  }
  return sum / weights;
}

Radiance SkyMap::brightest() const {
  Radiance most = Radiance::Zero();
  for (const Eigen::Vector3f& texel : texels_) most = most.cwiseMax(texel.cast<double>());
  return most;
}

Radiance Light::mean_irradiance() const {
  Radiance sum = sky.mean();
  // The mean of a clamped cosine over the sphere is a quarter.
  for (const Sun& sun : suns) sum += sun.irradiance / 4;
  return sum;
}

Light Light::scaled(const Radiance& factors) const {
  Light result{sky.scaled(factors), suns, bounce.cwiseProduct(factors)};
  for (Sun& sun : result.suns) sun.irradiance = sun.irradiance.cwiseProduct(factors);
  return result;
}

Light sky_and_sun(const Radiance& ground, const Radiance& zenith, const Sun& sun, const Radiance& bounce,
                  const Vec3& up) {
  Light light;
  light.sky = SkyMap(64, [&](const Vec3& d) -> Radiance {
    const double t = d.dot(up) * 0.5 + 0.5;
    return ground * (1 - t) + zenith * t;
  });
  if (!sun.irradiance.isZero(0)) light.suns.push_back(sun);
  light.bounce = bounce;
  return light;
}

bool SceneLight::operator==(const SceneLight& other) const {
  const auto plain = [](const SceneLight& one) {
    return std::tie(one.self, one.cast, one.removed, one.highlights, one.match, one.budget, one.rays, one.source,
                    one.picture_rotation, one.zenith, one.ground, one.sun, one.bounce, one.up);
  };
  if (plain(*this) != plain(other) || (picture == nullptr) != (other.picture == nullptr)) return false;
  return picture == other.picture || *picture == *other.picture;
}

std::shared_ptr<const Light> given_light(const SceneLight& settings) {
  if (settings.source == SceneLight::Source::estimated) return nullptr;
  if (settings.source == SceneLight::Source::sky) {
    Sun sun = settings.sun;
    sun.direction.stableNormalize();
    return std::make_shared<const Light>(
        sky_and_sun(settings.ground, settings.zenith, sun, settings.bounce, settings.up));
  }
  auto light = std::make_shared<Light>();
  if (settings.source == SceneLight::Source::picture) {
    if (!settings.picture) return nullptr;
    *light = settings.picture->light;
    light->bounce = settings.bounce;
    if (settings.picture_rotation == 0) return light;
    const Mat3 turn = Eigen::AngleAxisd(settings.picture_rotation, Vec3::UnitY()).toRotationMatrix();
    light->sky =
        SkyMap(light->sky.side(), [&, sky = light->sky](const Vec3& d) { return sky.at(turn.transpose() * d); });
    for (Sun& sun : light->suns) sun.direction = turn * sun.direction;
    return light;
  }
  light->sky = SkyMap(settings.zenith);
  light->bounce = settings.bounce;
  return light;
}

double to_linear(double display) {
  return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}
double to_display(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace rebake
