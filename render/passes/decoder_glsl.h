#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/graph/plan.h"

namespace rebake {

/// GLSL text of `vec3 decode(int k, vec4 low, vec4 high, vec3 ray)` with all weights as literals.
std::string decoder_constants_glsl(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                                   RenderOptions::Precision precision);

/// The same weights for decoder_buffer.glsl.
struct DecoderBuffers {
  std::vector<float> weights;  ///< a neuron's bias, then its weights; padded to whole texels
  std::vector<float> layout;   ///< four floats a decoder: first weight, hidden widths, 0
  int widest_layer = 1;
};
DecoderBuffers decoder_buffers(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                               RenderOptions::Precision precision);

}  // namespace rebake
