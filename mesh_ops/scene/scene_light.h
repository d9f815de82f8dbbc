#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Linear RGB radiance, or irradiance over π. In these units, a diffuse surface's colour is its albedo times the
/// cosine-weighted mean radiance over the half-space above it.
using Radiance = Eigen::Vector3d;

/// Environment map: radiance per direction, stored as an octahedral map (Engelhardt and Dachsbacher 2008) with bilinear
/// lookup.
class SkyMap {
 public:
  /// Samples `radiance(direction)` at the centres of `side`² texels.
  template <class Function>
  SkyMap(int side, Function radiance) : SkyMap(side) {
    for (std::size_t k = 0; k < texels_.size(); ++k) texels_[k] = Radiance(radiance(direction(k))).cast<float>();
  }
  explicit SkyMap(const Radiance& uniform = Radiance::Zero());

  /// Radiance along the unit vector `direction`, which points towards the sky.
  Radiance at(const Vec3& direction) const;
  bool black() const;
  /// Mean over all directions.
  Radiance mean() const;
  /// Maximum per channel.
  Radiance brightest() const;
  int side() const { return side_; }
  /// Downsampled map: each texel is the mean of `factor`² texels. `factor` must divide the side.
  SkyMap coarser(int factor) const;
  /// Each channel multiplied by its factor.
  SkyMap scaled(const Radiance& factors) const;
  const std::vector<Eigen::Vector3f>& texels() const { return texels_; }
  /// Unit direction of a texel's centre.
  Vec3 direction(std::size_t texel) const;
  bool operator==(const SkyMap&) const = default;

 private:
  explicit SkyMap(int side);

  int side_;
  std::vector<Eigen::Vector3f> texels_;  ///< row-major
};

/// Directional light with the angular size of a disk.
struct Sun {
  Vec3 direction{0, 1, 0};       ///< unit vector towards the sun
  double radius = 0.1;           ///< angular radius, radians
  Radiance irradiance{0, 0, 0};  ///< irradiance over π of a surface that faces the sun
  bool operator==(const Sun&) const = default;
};

/// Distant light on an object: an environment map and suns.
struct Light {
  SkyMap sky;
  std::vector<Sun> suns;
  Radiance bounce{0, 0, 0};  ///< radiance of occluders: a rough model of light bounced between surfaces
  /// Irradiance over π of an unoccluded surface, averaged over all orientations.
  Radiance mean_irradiance() const;
  /// Each channel multiplied by its factor.
  Light scaled(const Radiance& factors) const;
  bool operator==(const Light&) const = default;
};

/// Light read from an equirectangular image file.
struct LightPicture {
  std::string path;
  std::string content;  ///< hash of the file's bytes
  Light light;          ///< the image's centre is at −z, its top edge at +y
  bool operator==(const LightPicture&) const = default;
};

/// Settings of relighting: baked colours follow edits of the scene.
struct SceneLight {
  bool self = true;           ///< update the light on triangles that moved within their object
  bool cast = true;           ///< objects occlude each other's light
  bool removed = true;        ///< removed triangles no longer occlude light
  bool highlights = true;     ///< specular reflections of rotated triangles follow the light
  bool match = false;         ///< one light in world space for all objects: the given one, or the first object's
  double budget = 1.0 / 255;  ///< largest error of display colours allowed for skipped effects
  int rays = 256;             ///< rays per half-space from each surface point, 16 … 16384

  enum class Source { estimated, uniform, sky, picture };
  Source source = Source::estimated;            ///< estimated from object colours, or given in the space of their files
  std::shared_ptr<const LightPicture> picture;  ///< light of source `picture`
  double picture_rotation = 0;                  ///< rotation of the picture about +y, radians
  Radiance zenith{0.75, 0.88, 1.1};  ///< sources `uniform` and `sky`: radiance from above (`uniform`: from everywhere)
  Radiance ground{0.34, 0.3, 0.27};  ///< source `sky`: radiance from below
  Sun sun{{0.5, 0.8, 0.45}, 0.09, {1.15, 1.05, 0.9}};  ///< source `sky`; the direction may have any length
  Radiance bounce{0, 0, 0};                            ///< radiance of occluders, see Light::bounce
  Vec3 up{0, 1, 0};                                    ///< source `sky`: unit vector to the zenith, the ground's normal
  /// Compares pictures by content.
  bool operator==(const SceneLight& other) const;
};
/// The given light; null if the source is `estimated`, or `picture` without a picture.
std::shared_ptr<const Light> given_light(const SceneLight& settings);

/// A sky whose radiance blends linearly from `ground` to `zenith` over height along the unit vector `up`, and a sun.
Light sky_and_sun(const Radiance& ground, const Radiance& zenith, const Sun& sun, const Radiance& bounce,
                  const Vec3& up = Vec3::UnitY());

/// sRGB transfer function of one channel (IEC 61966-2-1): display to linear, and its inverse.
double to_linear(double display);
double to_display(double linear);

}  // namespace rebake
