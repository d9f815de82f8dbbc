#include <fmt/format.h>

#include <random>

#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using Weights = RenderOptions::Weights;
using Shading = RenderOptions::Shading;
using Precision = RenderOptions::Precision;
using Arithmetic = RenderOptions::Arithmetic;

RenderOptions options_of(Weights weights, Shading shading, Precision precision = Precision::full,
                         Arithmetic arithmetic = Arithmetic::scalars) {
  RenderOptions options;
  options.weights = weights;
  options.shading = shading;
  options.precision = precision;
  options.arithmetic = arithmetic;
  return options;
}

// A decoder of this width with random weights, of the size of trained ones.
std::shared_ptr<const Decoder> random_decoder(int width) {
  std::mt19937 random(1);
  const auto fill = [&](auto& values, double reach) {
    for (Eigen::Index k = 0; k < values.size(); ++k) values.data()[k] = reach * (random() / 2147483647.5 - 1);
  };
  auto decoder = std::make_shared<Decoder>();
  decoder->weights0.resize(Decoder::inputs, width);
  decoder->bias0.resize(width);
  decoder->weights1.resize(width, width);
  decoder->bias1.resize(width);
  decoder->weights2.resize(width, 3);
  decoder->bias2.resize(3);
  const double reach = 2 / std::sqrt(width);
  fill(decoder->weights0, 1);
  fill(decoder->bias0, 0.5);
  fill(decoder->weights1, reach);
  fill(decoder->bias1, 0.5);
  fill(decoder->weights2, reach);
  fill(decoder->bias2, 0.5);
  return decoder;
}

// The scene with this decoder in all of its objects.
Scene with_decoder(const Scene& scene, const std::shared_ptr<const Decoder>& decoder) {
  Scene result = scene;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    auto object = std::make_shared<BakedObject>(*placed.node->object);
    object->decoder = decoder;
    result = with_changed(result, placed.node->id, [&](Node& node) { node.object = object; });
  }
  return result;
}

}  // namespace

StudyTable study_decoder(const StudyInput& input) {
  // One sample per pixel, since forward shading supports no more.
  StudyInput one = input;
  one.view.samples = 1;
  input.say("driver: " + input.renderer().device());
  const RenderOptions exact = options_of(Weights::constants, Shading::deferred);
  const Image reference = input.renderer().render(input.scene, one.view, exact);
  struct Choice {
    const char* name;
    RenderOptions options;
  };
  const Choice choices[] = {
      {"constants, float", exact},
      {"constants with zero weights",
       options_of(Weights::constants, Shading::deferred, Precision::full, Arithmetic::all_scalars)},
      {"constants, mat4 and vec4",
       options_of(Weights::constants, Shading::deferred, Precision::full, Arithmetic::vectors)},
      {"buffer, float", options_of(Weights::buffer, Shading::deferred)},
      {"buffer, weights rounded to half", options_of(Weights::buffer, Shading::deferred, Precision::half)},
      {"forward, constants", options_of(Weights::constants, Shading::forward)},
      {"forward, constants, mat4 and vec4",
       options_of(Weights::constants, Shading::forward, Precision::full, Arithmetic::vectors)},
      {"forward, buffer", options_of(Weights::buffer, Shading::forward)},
  };
  StudyTable table = picture_table();
  for (const Choice& choice : choices)
    table.rows.push_back(measured(one, choice.name, one.view, choice.options, reference));
  try {
    table.rows.push_back(
        measured(one, "constants, 16-bit floats", one.view,
                 options_of(Weights::constants, Shading::deferred, Precision::half, Arithmetic::halves), reference));
  } catch (const DeviceError& error) {
    input.say(fmt::format("there is no row of 16-bit floats: {}", error.what()));
  }
  for (const int width : {8, 16, 32, 64}) {
    const Scene scene = with_decoder(input.scene, random_decoder(width));
    const StudyInput wide{one.renderer, scene, one.view, one.frames, one.progress};
    const Image own = input.renderer().render(scene, one.view, exact);
    for (const auto& [name, arithmetic] :
         {std::pair{"scalars", Arithmetic::scalars}, {"mat4 and vec4", Arithmetic::vectors}})
      table.rows.push_back(measured(wide, fmt::format("random decoder of width {}, {}", width, name), one.view,
                                    options_of(Weights::constants, Shading::deferred, Precision::full, arithmetic),
                                    own));
    table.rows.push_back(measured(wide, fmt::format("random decoder of width {}, buffer", width), one.view,
                                  options_of(Weights::buffer, Shading::deferred), own));
  }
  return table;
}

}  // namespace rebake
