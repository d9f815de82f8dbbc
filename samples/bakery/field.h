#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "render/graph/render_view.h"
#include "render/image.h"
#include "samples/bakery/surface.h"

namespace rebake::bakery {

/// Radiance of a procedural model: direct light of a soft sun, sky with occlusion, one bounce and glossy highlights.
/// Shadow and occlusion are traced once, at the vertices of tessellations that are four times finer than the baked
/// quads, so the field is free of noise. Highlights are closed-form.
class RadianceField {
 public:
  /// `model` must outlive this object.
  explicit RadianceField(const Model& model);
  ~RadianceField();
  RadianceField(const RadianceField&) = delete;
  RadianceField& operator=(const RadianceField&) = delete;

  /// Display colour of a patch's point (u, v) along the unit view `direction`, from the eye to the point.
  Color color(std::size_t patch, double u, double v, const Vec3& direction) const;
  /// Unit normal at a patch's point, outwards.
  Vec3 normal(std::size_t patch, double u, double v) const;
  /// Visible shares of the sky and of the sun at a patch's point, 0 … 1.
  std::array<double, 2> openness(std::size_t patch, double u, double v) const;
  /// Height above surfaces at which light rays start if Patch::clearance is 0.
  double ray_offset() const;
  /// Irradiance / π at a patch's point, linear.
  Vec3 irradiance(std::size_t patch, double u, double v) const;
  /// Whether nothing opaque is between the eye and a patch's point.
  bool visible(const Vec3& eye, std::size_t patch, double u, double v) const;
  struct Hit {
    std::size_t patch;
    double u, v;
    double distance;
  };
  /// Nearest opaque point along a ray of unit direction; nothing if there is none.
  std::optional<Hit> hit(const Vec3& eye, const Vec3& direction) const;
  /// Ray-traced picture with 64 rays per pixel, composited over white in display colours, as the format's rendering
  /// rule does.
  Image trace(const Camera& camera, int width, int height) const;
  /// The same with other display colours: `color(patch, u, v, direction)`.
  using Shade = std::function<Color(std::size_t patch, double u, double v, const Vec3& direction)>;
  Image trace(const Camera& camera, int width, int height, const Shade& color) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake::bakery
