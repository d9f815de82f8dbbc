#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"
#include "render/image.h"

namespace rebake {

/// A photograph as a view without lens distortion, with square pixels and a central principal point would show it.
struct Photograph {
  std::string name;                 ///< as the camera file names it
  Camera camera;                    ///< vertical angle of view; no planes unless the file states them
  Image image;                      ///< without alpha
  std::vector<std::uint8_t> valid;  ///< per pixel: 0 where the photograph shows nothing, or its mask leaves it out
  bool resampled = false;           ///< bilinear, because of distortion, pixels that are not square, or another centre
};

/// Reads the photograph of a camera. `folder`: capture_folder(). `camera`: with intrinsics for any size of the file, to
/// which they are scaled; `view`: its entry of views_of(). Where it is transparent, it shows `background`
/// (display colours, 0 … 1). Throws FileError for a missing or unreadable photograph or mask, and FieldError for an
/// invalid camera.
Photograph read_photograph(const PhotoCamera& camera, const Camera& view, const std::filesystem::path& folder,
                           const Vec3& background);

/// Errors of a picture against a photograph, over its valid pixels.
struct PhotographErrors {
  std::size_t pixels = 0;   ///< valid ones
  double psnr_db = 0;       ///< infinity for equal pixels
  double ssim = 1;          ///< see Difference::ssim
  double flip = 0;          ///< mean, see flip_map()
  std::vector<double> map;  ///< flip_map(), 0 for invalid pixels
};
/// Throws Error if the sizes differ or no pixel is valid.
PhotographErrors errors_against(const Photograph& photograph, const Image& picture);

/// The gain per channel that brings a picture closest to a photograph, in linear light (least squares over valid pixels
/// that are not clipped in either): differences of exposure and white balance. 1 if there are none.
Vec3 exposure_gain(const Photograph& photograph, const Image& picture);
/// Makes pixels with a clipped channel invalid: a gain does not bring their colours back.
void leave_out_clipped(Photograph& photograph);
/// The picture in linear light times a gain per channel.
Image with_gain(const Image& picture, const Vec3& gain);

/// Errors 0 … 1 as colours from black over purple and orange to light yellow.
Image error_colors(const std::vector<double>& errors, int width, int height);

}  // namespace rebake
