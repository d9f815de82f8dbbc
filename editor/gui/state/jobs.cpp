#include "editor/gui/state/jobs.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rebake {

void Jobs::measure_costs(const ViewState& view, const Scene& scene) {
  auto measured = std::make_shared<Costs>();
  // The reference needs 64 samples per pixel; larger pictures may exceed the limits of drivers.
  constexpr double max_pixels = 1e6;
  const double scale = std::min(1.0, std::sqrt(max_pixels / (static_cast<double>(view.width) * view.height)));
  measured->view = {view.camera, std::max(1, static_cast<int>(view.width * scale)),
                    std::max(1, static_cast<int>(view.height * scale)), 4};
  measured->roots = scene.roots;
  measured->background = scene.background;
  worker.start(
      "measure",
      [measured](Session& session) {
        constexpr int frames = 5;  // times are medians of 5
        const StudyInput input{[&session]() -> Renderer& { return session.renderer(); }, session.scene(),
                               measured->view, frames, session.progress};
        for (const auto study : {study_samples, study_resolution})
          for (StudyTable::Row& row : study(input).rows) measured->rows.push_back(std::move(row));
        measured->device = session.renderer().device();
        session.drop_renderer();  // frees a second copy of the scene on the GPU
      },
      [this, measured] { costs = measured; });
}

}  // namespace rebake
