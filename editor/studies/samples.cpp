#include "editor/studies/study.h"

namespace rebake {

std::vector<StudyRow> study_samples(const StudyInput& input) {
  View view = input.view;
  view.samples = 64;
  const Image reference = input.renderer.render(input.scene, view);
  std::vector<StudyRow> rows;
  for (const int samples : {1, 4, 16}) {
    view.samples = samples;
    rows.push_back(
        measured(input, std::to_string(samples) + (samples == 1 ? " sample" : " samples"), view, {}, reference));
  }
  return rows;
}

}  // namespace rebake
