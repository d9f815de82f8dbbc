#pragma once

#include <filesystem>
#include <vector>

#include "editor/studies/dprt/animated_object.h"
#include "mesh_ops/light/learned/geometry_image.h"
#include "mesh_ops/light/transport/light_sites.h"

namespace rebake {

/// The frames of an animated object as geometry images, with traced transfer per texel.
struct TracedFrames {
  int side = 0;                           ///< texels per side
  ProxyMesh rest;                         ///< a vertex per texel, row by row
  std::vector<std::vector<Vec3>> frames;  ///< [frame][texel]: positions
  std::vector<std::vector<float>>
      transfer;             ///< [frame][16 × texels]: coefficients, plane by plane, in the body's space
  std::uint64_t hash = 0;   ///< of the frames, the side and the rays
  double undersampled = 0;  ///< share of the surface; see GeometryImage::undersampled()
  bool mean_value = false;  ///< mean value weights instead of harmonic ones, which would fold
};

/// Positions of the texels for positions of the vertices.
std::vector<Vec3> texel_positions(const GeometryImage& image, const std::vector<Vec3>& vertices);

/// Rotations since rest and light sites of a pose, per texel.
struct FrameSites {
  std::vector<Mat3> turns;  ///< rotation of the surface since rest
  std::vector<LightSite> sites;
};
FrameSites sites_of(const ProxyMesh& rest, const std::vector<Vec3>& frame);

/// Poses to measure errors on have this many times as many rays as those to train on.
inline constexpr int truth_rays_per_ray = 16;

/// Every tenth frame is held out, as published in number.
constexpr bool is_held_out(std::size_t frame) { return frame % 10 == 5; }

/// Lays the object out over a square of `side`² texels by a harmonic map, and traces each frame with `rays` rays per
/// texel; held-out frames with truth_rays_per_ray times as many. `cache`: start of the name of a file that keeps traced
/// frames, so that an interrupted call goes on; empty: none. Surfaces that are no disk are cut. Throws Error for those
/// that are not manifold or not connected, FileError, and Cancelled.
TracedFrames traced_frames(const AnimatedObject& object, int side, int rays, const std::filesystem::path& cache,
                           const Progress& progress);

/// Traces single poses of the texels of `like`; see TracedFrames::transfer.
std::vector<float> traced_planes(const ProxyMesh& rest, const std::vector<Vec3>& frame, int rays);

}  // namespace rebake
