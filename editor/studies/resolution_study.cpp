#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "editor/studies/study.h"

namespace rebake {

StudyTable study_resolution(const StudyInput& input) {
  View view = input.view;
  view.samples = 64;
  const Image reference = input.renderer().render(input.scene, view);
  view.samples = 1;
  StudyTable table = picture_table();
  for (const int percent : {100, 70, 50, 35}) {
    View smaller = view;
    smaller.width = std::max(1, static_cast<int>(std::lround(view.width * percent / 100.0)));
    smaller.height = std::max(1, static_cast<int>(std::lround(view.height * percent / 100.0)));
    table.rows.push_back(measured(input, fmt::format("{} %, 1 sample", percent), smaller, {}, reference));
    input.progress.at("resolutions", static_cast<double>(table.rows.size()) / 4);
  }
  return table;
}

}  // namespace rebake
