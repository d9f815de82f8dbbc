#pragma once

#include "editor/training/capture.h"
#include "mesh_ops/reconstruction/reconstruction.h"
#include "mesh_ops/scene/scene.h"
#include "render/picture.h"

namespace rebake {

/// PSNR in dB, at most 100, of a mean squared error of colours in [0, 1]; not a number for one that is none.
double decibels_of(double mean_squared_error);

/// Mean errors over held-out photographs.
struct MeanErrors {
  double psnr_db = 0, ssim = 0, flip = 0;
};

/// Simple pictures that a trained scene must beat, and the trained scene before it is baked.
struct TrainingBaselines {
  double mean_color_db = 0;          ///< PSNR of one colour, the mean of the training photographs
  double nearest_photograph_db = 0;  ///< PSNR of the training photograph with the most similar camera, as it is
  double white_db = 0;               ///< PSNR of a white picture
};
TrainingBaselines baselines(const std::vector<FitPhotograph>& training, const std::vector<Photograph>& held_out);

/// Mean PSNR in dB of the trained scene as it is drawn in stage 2, before baking.
double held_out_psnr(const Reconstruction& training, const Capture& capture, const Progress& progress);

/// Errors of a scene, rendered with 4 samples per pixel. `gain`: brings each picture to the exposure of its photograph
/// first. Throws DeviceError without OpenGL.
MeanErrors held_out_errors(Renderer& renderer, const Scene& scene, const Capture& capture, bool gain,
                           const Progress& progress);

/// A picture of the trained scene from the camera of a photograph, as it is drawn in stage 2. Throws Cancelled.
Image trained_picture(const Reconstruction& training, const FitPhotograph& photograph, const Progress& progress);
/// The photograph with at most `most` pixels per side, without mask.
FitPhotograph reduced(const FitPhotograph& photograph, int most);

}  // namespace rebake
