#pragma once

#include <array>
#include <cstdint>

#include "mesh_ops/base/types.h"
#include "render/gpu_scene/clusters.h"
#include "render/passes/depth_pyramid.h"

namespace rebake {

/// Conservative bounds of the samples that a box or triangle may cover.
struct ScreenBounds {
  enum class Where : std::int32_t {
    outside,   ///< covers no sample of the drawn rectangle
    inside,    ///< covers samples within `samples` only
    anywhere,  ///< too close to the eye for a bound
  };
  Where where = Where::anywhere;
  SampleRect samples;  ///< here right and top are included
};

/// Bounds of a cluster's triangles, as one array per field for SIMD.
struct ClusterBounds {
  template <class T>
  using Each = std::array<T, max_faces_per_cluster>;
  Each<std::int32_t> left, bottom, right, top;  ///< as ScreenBounds::samples; empty if no sample is covered
  Each<float> nearness;      ///< upper bound; infinity for triangles so thin that their depth is rounding noise
  Each<std::int32_t> where;  ///< ScreenBounds::Where

  std::array<Each<float>, 3> x, y, z;  ///< corners in normalised device coordinates
  Each<float> moved, error;            ///< as in ScreenTriangle

  SampleRect samples(std::size_t k) const { return {left[k], bottom[k], right[k], top[k]}; }
};

/// Computes conservative screen-space bounds: no driver draws outside them. They allow for the driver's float rounding
/// and for its snapping of corners to 1/256 of a sample.
class ScreenBounder {
 public:
  /// `to_clip`: object to clip space. `bounds`: bounding box of the drawn mesh in object space. `nearness_of_depth`: as
  /// from nearness_of_depth(). `width`, `height`: raster in samples. `rect`: its drawn part.
  ScreenBounder(const Eigen::Matrix4d& to_clip, const Box& bounds, const Vec2& nearness_of_depth, int width, int height,
                const SampleRect& rect);

  /// Bounds of triangles within a box in object space. A box cannot bound their nearness, because drivers extrapolate
  /// depth on triangles seen edge-on.
  ScreenBounds box(const Box& box) const;
  /// Bounds of a cluster's triangles, with corners relative to the centre of the mesh's bounding box.
  void triangles(const ClusterCorners& corners, ClusterBounds& bounds) const;
  /// Triangle `k` of a cluster. Requires Where::inside and finite nearness.
  ScreenTriangle triangle(const ClusterBounds& bounds, std::size_t k) const;

 private:
  ScreenBounds covered(double left, double bottom, double right, double top) const;

  Eigen::Matrix4d to_clip_;
  Eigen::Matrix4f centred_;     ///< the same for positions relative to the centre
  Eigen::Vector4d clip_error_;  ///< bound of the float error per component
  double factor_, offset_;
  double half_width_, half_height_;
  SampleRect rect_;
};

}  // namespace rebake
