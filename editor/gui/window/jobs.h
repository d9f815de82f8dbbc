#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/values.h"
#include "editor/gui/view/view_state.h"
#include "editor/gui/window/film.h"
#include "editor/gui/window/worker.h"
#include "editor/studies/study.h"

namespace rebake {

/// Long work: the worker's, and what the window itself carries out, a picture a frame.
struct Jobs {
  explicit Jobs(std::function<void()> wake) : worker(std::move(wake)) {}

  Worker worker;
  bool restarts_graphics = false;

  struct Screenshot {
    std::filesystem::path path;
    int width = 0, height = 0;  ///< pixels
  };
  std::optional<Screenshot> screenshot;
  std::optional<Film> film;
  std::vector<NodeRef> pictured;  ///< only these are in them; empty: all

  /// What choices cost and how wrong each is, in one view of one scene.
  struct Costs {
    View view;
    std::vector<NodePtr> roots;
    Color background;
    std::vector<StudyTable::Row> rows;  ///< as picture_table() has them
    std::string device;
  };
  std::shared_ptr<const Costs> costs;
  /// Fills `costs` for what is looked at now.
  void measure_costs(const ViewState& view, const Scene& scene);
};

}  // namespace rebake
