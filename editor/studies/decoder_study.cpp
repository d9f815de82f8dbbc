#include "editor/studies/study.h"

namespace rebake {

StudyTable study_decoder(const StudyInput& input) {
  using Weights = RenderOptions::Weights;
  using Shading = RenderOptions::Shading;
  using Precision = RenderOptions::Precision;
  // One sample per pixel, since forward shading supports no more.
  View view = input.view;
  view.samples = 1;
  const Image reference =
      input.renderer().render(input.scene, view, {Weights::constants, Shading::deferred, Precision::full});
  struct Choice {
    const char* name;
    RenderOptions options;
  };
  const Choice choices[] = {
      {"constants, float", {Weights::constants, Shading::deferred, Precision::full}},
      {"buffer, float", {Weights::buffer, Shading::deferred, Precision::full}},
      {"buffer, half", {Weights::buffer, Shading::deferred, Precision::half}},
      {"forward, constants", {Weights::constants, Shading::forward, Precision::full}},
      {"forward, buffer", {Weights::buffer, Shading::forward, Precision::full}},
  };
  StudyTable table = picture_table();
  for (const Choice& choice : choices)
    table.rows.push_back(measured(input, choice.name, view, choice.options, reference));
  return table;
}

}  // namespace rebake
