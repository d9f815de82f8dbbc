#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Linear RGB light. Radiances are in units of what a white matte surface sends back, so that a surface's colour is its
/// albedo times the mean radiance over the cosine-weighted half space above it.
using Radiance = Eigen::Vector3d;

/// Radiance for every direction: an octahedral map (Engelhardt and Dachsbacher 2008), looked up bilinearly.
class SkyMap {
 public:
  /// `radiance(direction)` at the centres of `side`² texels.
  template <class Function>
  SkyMap(int side, Function radiance) : SkyMap(side) {
    for (std::size_t k = 0; k < texels_.size(); ++k) texels_[k] = Radiance(radiance(direction(k))).cast<float>();
  }
  explicit SkyMap(const Radiance& uniform = Radiance::Zero());

  /// `direction` of length 1, towards the sky.
  Radiance at(const Vec3& direction) const;
  bool black() const;
  /// Over all directions.
  Radiance mean() const;
  /// The most of each channel.
  Radiance brightest() const;
  int side() const { return side_; }
  /// Means of `factor`² texels each; `factor` divides the side.
  SkyMap coarser(int factor) const;
  SkyMap scaled(const Radiance& factors) const;
  const std::vector<Eigen::Vector3f>& texels() const { return texels_; }
  /// Of a texel's centre.
  Vec3 direction(std::size_t texel) const;
  bool operator==(const SkyMap&) const = default;

 private:
  explicit SkyMap(int side);

  int side_;
  std::vector<Eigen::Vector3f> texels_;  ///< row-major
};

/// A disk in the sky.
struct Sun {
  Vec3 direction{0, 1, 0};       ///< towards it, of length 1
  double radius = 0.1;           ///< angular, radians
  Radiance irradiance{0, 0, 0};  ///< over π, of a surface that faces it
  bool operator==(const Sun&) const = default;
};

/// What shines on an object from afar.
struct Light {
  SkyMap sky;
  std::vector<Sun> suns;
  Radiance bounce{0, 0, 0};  ///< radiance of what hides the sky: light between surfaces, roughly
  /// Of a surface that nothing hides anything of, over π: its mean over all ways it may face.
  Radiance mean_irradiance() const;
  /// A channel by a factor.
  Light scaled(const Radiance& factors) const;
  bool operator==(const Light&) const = default;
};

/// Light of an equirectangular picture, as it was read.
struct LightPicture {
  std::string path;
  std::string content;  ///< hash of the file
  Light light;          ///< its middle towards −z, its upper edge +y
  bool operator==(const LightPicture&) const = default;
};

/// What light does in a scene whose light follows edits.
struct SceneLight {
  bool self = true;           ///< triangles that moved are shaded anew
  bool cast = true;           ///< objects shade each other
  bool removed = true;        ///< what is gone shades no more
  bool highlights = true;     ///< what surfaces mirror stays with the light where triangles have turned
  bool match = false;         ///< all objects stand in one light: the given one, or as the first object's shines
  double budget = 1.0 / 255;  ///< of display colours, by which a picture may be off for what is left out
  int rays = 256;             ///< from each point of a surface, 16 … 16384

  enum class Source { estimated, uniform, sky, picture };
  Source source =
      Source::estimated;  ///< from each object's colours, or given in the objects' own spaces as they were read:
  std::shared_ptr<const LightPicture> picture;         ///< of that source
  double picture_turn = 0;                             ///< of it, about +y, radians
  Radiance zenith{0.75, 0.88, 1.1};                    ///< uniform and sky: from above
  Radiance ground{0.34, 0.3, 0.27};                    ///< sky: from below
  Sun sun{{0.5, 0.8, 0.45}, 0.09, {1.15, 1.05, 0.9}};  ///< sky; of any length
  Radiance bounce{0, 0, 0};                            ///< of what hides the sky
  Vec3 up{0, 1, 0};                                    ///< sky: towards the zenith, the normal of the scene's ground
  /// Of pictures by what they hold.
  bool operator==(const SceneLight& other) const;
};
/// The given light; null where it is estimated, and of a picture that is not there.
std::shared_ptr<const Light> given_light(const SceneLight& settings);

/// Sky colours below, at the horizon's level and above (a linear blend over height along the unit vector `up`), and a
/// sun.
Light sky_and_sun(const Radiance& ground, const Radiance& zenith, const Sun& sun, const Radiance& bounce,
                  const Vec3& up = Vec3::UnitY());

/// Linear light of a display colour and back (IEC 61966-2-1), a channel.
double to_linear(double display);
double to_display(double linear);

}  // namespace rebake
