#include "editor/edits/shape/slim.h"

#include <fmt/format.h>

#include <algorithm>

#include "editor/actions/plain_scene.h"
#include "editor/studies/folder_size.h"
#include "editor/studies/study.h"

namespace rebake {

StudyTable study_slim(const StudyInput& input) {
  StudyTable table{{"megabytes", "image PSNR dB (at most 70)", "milliseconds per frame", "worst image dB", "triangles"},
                   {},
                   0,
                   1,
                   false,
                   false};
  table.second_x = 2;
  // The infinite PSNR of equal images cannot be plotted: cap it.
  constexpr double equal_db = 70;
  const auto add = [&](const std::string& name, const Scene& scene) {
    PlainReport report;
    constexpr int size = 400;
    measure_pictures(input.renderer(), input.scene, {}, scene, report, input.progress, size);
    table.rows.push_back({name,
                          {folder_megabytes(scene), std::min(equal_db, report.whole.psnr_db),
                           median_frame_ms(input.renderer(), scene, input.view, input.frames),
                           std::min(equal_db, report.whole.worst_psnr_db), static_cast<double>(triangles_in(scene))}});
  };
  add("original", input.scene);
  for (const int rays : {64, 1024, Slim{}.rays}) {
    Slim edit;
    edit.rays = rays;
    add(fmt::format("at most {} rays", rays), apply(input.scene, edit, input.progress).scene);
  }
  for (const double psnr : {50.0, 45.0, 40.0, 35.0, 30.0}) {
    Slim edit;
    edit.psnr = psnr;
    add(fmt::format("psnr {:.0f}", psnr), apply(input.scene, edit, input.progress).scene);
  }
  return table;
}

}  // namespace rebake
