#pragma once

#include <array>
#include <cstdint>

#include "mesh_ops/base/types.h"
#include "render/gpu_scene/clusters.h"
#include "render/passes/depth_pyramid.h"

namespace rebake {

/// Which samples of a raster something may cover.
struct ScreenBounds {
  enum class Where : std::int32_t {
    outside,   ///< of the raster's rectangle, or between its samples
    inside,    ///< within `samples`
    anywhere,  ///< it comes too near to the eye to say
  };
  Where where = Where::anywhere;
  SampleRect samples;  ///< right and top included
};

/// The same of a cluster's triangles, and how near they may come there, each in an array of its own.
struct ClusterBounds {
  template <class T>
  using Each = std::array<T, faces_a_face_cluster>;
  Each<std::int32_t> left, bottom, right, top;  ///< as ScreenBounds::samples; empty where nothing is covered
  Each<float> nearness;  ///< above all where a triangle is so thin that what drivers draw of it is rounding
  Each<std::int32_t> where;

  std::array<Each<float>, 3> x, y, z;  ///< corners, over w
  Each<float> moved, error;            ///< as of ScreenTriangle

  SampleRect samples(std::size_t k) const { return {left[k], bottom[k], right[k], top[k]}; }
};

/// Bounds what a driver draws of triangles and boxes, so that nothing it draws lies outside them: with room for the
/// driver's floats, and for corners that it rounds to 1/256 of a sample.
class ScreenBounder {
 public:
  /// `to_clip`: object to clip space. `bounds`: what is drawn, in object space. `nearness_of_depth`: factor and offset
  /// that make of z / w in clip space 1 at the near plane and 0 at the far one.
  ScreenBounder(const Eigen::Matrix4d& to_clip, const Box& bounds, const Vec2& nearness_of_depth, int width, int height,
                const SampleRect& rect);

  /// Where triangles within the box may be drawn, in object space. How near they come does not follow from their box:
  /// on triangles that are seen edge-on drivers extrapolate depth.
  ScreenBounds box(const Box& box) const;
  /// Of triangles given relative to the centre of what is drawn.
  void triangles(const ClusterCorners& corners, ClusterBounds& bounds) const;
  /// One of those that is inside and whose nearness has a bound.
  ScreenTriangle triangle(const ClusterBounds& bounds, std::size_t k) const;

 private:
  ScreenBounds covered(double left, double bottom, double right, double top) const;

  Eigen::Matrix4d to_clip_;
  Eigen::Matrix4f centred_;     ///< the same from the centre
  Eigen::Vector4d clip_error_;  ///< of each component, as worked out in floats
  double factor_, offset_;
  double half_width_, half_height_;
  SampleRect rect_;
};

}  // namespace rebake
