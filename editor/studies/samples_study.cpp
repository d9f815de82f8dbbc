#include "editor/studies/study.h"

namespace rebake {

StudyTable study_samples(const StudyInput& input) {
  View view = input.view;
  view.samples = 64;
  const Image reference = input.renderer().render(input.scene, view);
  StudyTable table = picture_table();
  for (const int samples : {1, 4, 16}) {
    view.samples = samples;
    table.rows.push_back(
        measured(input, std::to_string(samples) + (samples == 1 ? " sample" : " samples"), view, {}, reference));
    input.progress.at("samples", static_cast<double>(table.rows.size()) / 3);
  }
  return table;
}

}  // namespace rebake
