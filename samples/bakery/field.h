#pragma once

#include <array>
#include <memory>
#include <vector>

#include "render/graph/view.h"
#include "render/image.h"
#include "samples/bakery/surface.h"

namespace rebake::bakery {

/// The model's radiance: direct light of a soft sun, sky with occlusion, one bounce and glossy highlights. Surfaces are
/// traced as fine tessellations of the procedural patches (several times finer than the quads baked from them); shadow
/// and occlusion are traced once at their vertices, so that the field is free of noise, and highlights are closed-form.
class RadianceField {
 public:
  explicit RadianceField(const Model& model);
  ~RadianceField();
  RadianceField(const RadianceField&) = delete;
  RadianceField& operator=(const RadianceField&) = delete;

  /// Display colour of a patch's point seen along `direction` (from the eye, unit length).
  Color color(std::size_t patch, double u, double v, const Vec3& direction) const;
  /// Unit normal, outwards.
  Vec3 normal(std::size_t patch, double u, double v) const;
  /// Share of sky and sun that reach the point.
  std::array<double, 2> openness(std::size_t patch, double u, double v) const;
  /// How far above surfaces rays for their light start, where the patch does not say.
  double clearance() const;
  /// Irradiance over π.
  Vec3 irradiance(std::size_t patch, double u, double v) const;
  /// False when something opaque lies between the eye and the point.
  bool visible(const Vec3& eye, std::size_t patch, double u, double v) const;
  /// A picture with 64 rays a pixel, composited over white in display colours as the format's rule does.
  Image trace(const Camera& camera, int width, int height) const;
  /// The same surfaces with other display colours: `color(patch, u, v, direction)`.
  using Shade = std::function<Color(std::size_t patch, double u, double v, const Vec3& direction)>;
  Image trace(const Camera& camera, int width, int height, const Shade& color) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake::bakery
