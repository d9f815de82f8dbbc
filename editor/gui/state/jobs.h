#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/values.h"
#include "editor/gui/state/camera_animation.h"
#include "editor/gui/state/view_state.h"
#include "editor/gui/state/worker.h"
#include "editor/studies/study.h"

namespace rebake {

/// Long operations: the worker's jobs, and rendering jobs that the viewport runs with one picture per frame.
struct Jobs {
  explicit Jobs(std::function<void()> wake) : worker(std::move(wake)) {}

  Worker worker;
  bool restarts_graphics = false;  ///< request to recreate all GPU objects

  /// What pictures show: a scene, and of it these nodes; none: all.
  struct Rendered {
    Scene scene;
    std::vector<NodeRef> nodes;
  };
  struct Screenshot {
    std::filesystem::path path;
    int width = 0, height = 0;  ///< size in pixels
    Rendered shows;
  };
  std::optional<Screenshot> screenshot;  ///< screenshot to be written in the next frame
  std::optional<CameraAnimation> film;   ///< running animation job
  Rendered film_shows;                   ///< the scene and nodes when it was started
  void end_film() {
    film.reset();
    film_shows = {};
  }

  /// Measured time and error of rendering choices, for one view of one scene.
  struct Costs {
    View view;
    std::vector<NodePtr> roots;
    Color background;
    std::vector<StudyTable::Row> rows;  ///< values in the columns of picture_table()
    std::string device;                 ///< name of the GPU
  };
  std::shared_ptr<const Costs> costs;  ///< the last measurement; null before the first
  /// Starts a job that measures samples per pixel and resolutions in this view and then sets `costs`.
  void measure_costs(const ViewState& view, const Scene& scene);
};

}  // namespace rebake
