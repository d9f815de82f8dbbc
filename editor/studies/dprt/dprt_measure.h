#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "editor/studies/dprt/transfer_methods.h"

namespace rebake {

/// Rays per texel of training frames.
inline constexpr int training_rays = 256;

/// A pose with its true transfer.
struct TestFrame {
  std::vector<Vec3> places;
  FrameSites sites;
  std::vector<float> truth;  ///< [16][texel]
};
std::vector<TestFrame> held_out_frames(const TracedFrames& traced);
/// Traces a pose.
TestFrame test_frame(const TracedFrames& traced, std::vector<Vec3> places);

/// Median time in milliseconds of a prediction, with what the method needs of the pose.
double milliseconds_of(const DprtMethod& method, const TracedFrames& traced, const TestFrame& test, int repeats);
/// Root mean square error over the coefficients of all texels and poses, in percent of their root mean square.
double percent_off(const DprtMethod& method, const std::vector<TestFrame>& tests, const Progress& progress);

/// Says how the object was laid out.
void say_layout(const StudyInput& input, const std::string& name, const TracedFrames& traced);

/// Appends the linear models and, if LibTorch is there, both networks; plots the losses of the published one and
/// returns it.
std::optional<DprtMethod> add_learned_methods(const StudyInput& input, const DprtOptions& options,
                                              const std::string& name, const TracedFrames& traced,
                                              std::vector<DprtMethod>& methods);

}  // namespace rebake
