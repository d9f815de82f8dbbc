#pragma once

#include <filesystem>

#include "editor/studies/dprt/traced_frames.h"
#include "editor/studies/study.h"

namespace rebake {

/// Writes four pictures of a pose side by side: in the light of a sky by the true transfer, by the predicted one, the
/// error of the colours (ten times, black: none), and the error of the coefficients (root mean square over the 16 of a
/// texel, white: 0.1). Says why if there is no OpenGL.
void write_dprt_picture(const StudyInput& input, const TracedFrames& traced, const std::vector<Vec3>& places,
                        const std::vector<float>& truth, const std::vector<float>& found,
                        const std::filesystem::path& file);

/// The same of a glossy surface (glossy_light()) with a grey ground: the paper's Figure 5. `sites`: of the pose.
void write_glossy_picture(const StudyInput& input, const TracedFrames& traced, const std::vector<Vec3>& places,
                          const std::vector<LightSite>& sites, const std::vector<float>& truth,
                          const std::vector<float>& found, const std::filesystem::path& file);

/// The eye of these pictures.
Vec3 eye_of_picture(const TracedFrames& traced, const std::vector<Vec3>& places);

}  // namespace rebake
