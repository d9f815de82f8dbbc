#pragma once

#include <vector>

#include "mesh_ops/refit/photograph_fit.h"
#include "mesh_ops/training/feature_network.h"

namespace rebake {

/// A ray in the normalised frame of a capture, with its direction as fed to the decoder.
struct TrainingRay {
  Vec3 origin, direction;    ///< the direction's length is that of depth 1 along the view axis
  std::array<float, 3> fed;  ///< unit
};

/// The pixels of photographs as rays with colours.
class TrainingViews {
 public:
  /// `to_unit`: from the scene to the normalised frame; a similarity. Throws Error if no pixel is valid.
  TrainingViews(std::vector<FitPhotograph> photographs, const Affine& to_unit, Axes axes);

  const std::vector<FitPhotograph>& photographs() const { return photographs_; }
  struct Pixel {
    std::size_t photograph;
    int x, y;
  };
  /// A random valid pixel; all are equally likely.
  Pixel pick(SplitMix64& dice) const;
  /// The ray through a point of a photograph, in pixels from its upper left corner.
  TrainingRay ray(std::size_t photograph, double x, double y) const;
  /// Display colour of a pixel, 0 … 1, with its photograph's gain removed.
  Vec3 color(const Pixel& pixel) const;
  /// Display colour of a pixel as it is in the photograph.
  Vec3 raw_color(const Pixel& pixel) const;
  /// Mean of all channels of all valid pixels, 0 … 1.
  double mean_brightness() const;
  /// Exposure and white balance of a photograph: its linear light is that of the scene times this. All 1 at first.
  void set_gain(std::size_t photograph, const Vec3& gain);

 private:
  std::vector<FitPhotograph> photographs_;
  std::vector<std::vector<std::uint32_t>> valid_;  // per photograph: numbers of valid pixels; empty: all
  std::vector<std::size_t> ends_;                  // per photograph: number of valid pixels in it and those before
  Affine to_unit_;
  Mat3 axes_;
  std::vector<Mat3> to_scene_;                                  // from camera axes
  std::vector<double> focal_;                                   // pixels
  std::vector<std::array<std::array<double, 256>, 3>> colors_;  // per photograph, channel and byte: the scene's colour
};

}  // namespace rebake
