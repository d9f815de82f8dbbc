#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/graph/plan.h"

namespace rebake {

/// The OpenGL extension that Arithmetic::halves needs.
inline constexpr const char* half_extension = "GL_AMD_gpu_shader_half_float";

/// GLSL text of `vec3 decode(int k, vec4 low, vec4 high, vec3 ray)` with weights as literals.
std::string decoder_constants_glsl(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                                   RenderOptions::Precision precision,
                                   RenderOptions::Arithmetic arithmetic = RenderOptions::Arithmetic::scalars);

/// Contents of the buffers of decoder_buffer.glsl.
struct DecoderBuffers {
  std::vector<float> weights;  ///< per neuron its bias, then its weights; padded to texels of four floats
  std::vector<float> layout;   ///< four floats per decoder: index of its first weight, two hidden widths, rule
  int widest_layer = 1;        ///< largest hidden width
};
DecoderBuffers decoder_buffers(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                               RenderOptions::Precision precision);

}  // namespace rebake
