#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "editor/edits/deform/deforming.h"
#include "editor/gui/window/settings.h"
#include "editor/gui/window/worker.h"
#include "editor/studies/study.h"
#include "render/graph/plan.h"

namespace rebake {

enum class ToolKind { pick, rectangle, lasso, polygon, brush, flood, erase, move, turn, scale, cage, bend };

/// A file or folder that a dialog asks for.
enum class PathQuestion {
  none,
  open,
  save_project,
  save_scene,
  export_folder,
  screenshot,
  turntable,
  save_script,
  run_script
};

/// What the window shows beside the document: panels, tools and commands act upon it. What people make is in the
/// document, which the worker owns; `now` is a copy.
struct Desk {
  explicit Desk(Settings with, std::function<void()> wake);

  Settings settings;
  Worker worker;
  std::shared_ptr<const Snapshot> now;

  // Looking
  Camera camera;
  int view_width = 1, view_height = 1;  ///< the viewport's pixels
  bool flying = false;
  bool show_selection = true;
  int samples = 4;
  Guides::Inspect inspect = Guides::Inspect::none;
  int channel = 1;
  bool wipe = false;     ///< the scene as imported is shown left of `wipe_at`
  double wipe_at = 0.5;  ///< share of the viewport's width
  Scene imported;        ///< as it was before anything but imports was done, or as a project was opened
  /// Drawn in place of the scene that it was made of, while something is dragged or typed, and until the job that
  /// carries it out has ended.
  struct Preview {
    Scene scene;
    std::vector<NodePtr> of;  ///< the roots of the scene that it was made of
  };
  std::optional<Preview> preview;
  void show_preview(Scene made) { preview = Preview{std::move(made), scene().roots}; }
  /// What the viewport draws.
  const Scene& shown() const { return preview && preview->of == scene().roots ? preview->scene : scene(); }

  // Tools
  ToolKind tool = ToolKind::pick;
  std::optional<ToolKind> drag_begins;  ///< takes hold of its target at once, without a button
  std::optional<ToolKind> tool_before;  ///< to come back to after such a drag
  bool visible_only = true;
  bool local_axes = false;
  std::set<NodeId> active;  ///< nodes that panels and gizmos work on

  // Talking
  struct Line {
    std::string text;
    bool failed = false;
  };
  std::vector<Line> log;
  std::string error;  ///< shown until it is read
  bool palette_open = false, quitting = false, restarts_graphics = false;
  PathQuestion question = PathQuestion::none;
  std::string form_op;  ///< the edit whose form is open, empty for none
  struct LostWork {
    std::filesystem::path journal;
    std::string what;  ///< how much, and of what
  };
  std::vector<LostWork> recoverable;
  /// Sources that a project or journal wants, and that are not where they were.
  struct Relinking {
    struct Source {
      std::filesystem::path path;
      std::string trouble;
      std::string now;  ///< where people say it is
    };
    std::filesystem::path wanted_by;
    std::vector<Source> sources;
  };
  std::optional<Relinking> relinking;
  std::filesystem::path project;     ///< empty until it has been saved
  std::vector<std::string> to_open;  ///< a project that waits for people's word

  // Long work that the window itself carries out, a picture a frame
  struct Screenshot {
    std::filesystem::path path;
    int width = 0, height = 0;  ///< pixels
  };
  std::optional<Screenshot> screenshot;
  struct Turntable {
    std::filesystem::path folder;
    int width = 0, height = 0, count = 36;
    int next = 0;  ///< number of the picture that comes
  };
  std::optional<Turntable> turntable;

  /// What choices cost and how wrong each is, in one view of one scene.
  struct Costs {
    View view;
    std::vector<NodePtr> roots;
    Color background;
    std::vector<StudyTable::Row> rows;  ///< milliseconds, dB, largest difference of 255
    std::string device;
  };
  std::shared_ptr<const Costs> costs;

  /// Takes in what the worker did.
  void update();

  void edit(const Edit& edit);
  /// All of them as one step of history, or none where one fails; `then` once they are done.
  void edits(const std::vector<Edit>& list, std::function<void()> then = {});
  void undo(int steps = 1);
  void redo(int steps = 1);
  /// Imports folders and scenes. A project, which must be the only path, takes the place of the document; with unsaved
  /// work in it, people are asked first unless it is `wanted` so.
  void open(const std::vector<std::string>& paths, bool wanted = false);
  /// Gets a journal's work back. Where sources are gone, people are asked for them first.
  void recover(const std::filesystem::path& journal, const Relinked& links = {}, bool go_on_without = false);
  /// With what `relinking` says: opens or recovers again. Without them: as far as a journal goes.
  void relink(bool go_on_without);
  void save_project(const std::filesystem::path& path);
  void save_scene(const std::filesystem::path& folder);
  void export_to(const std::filesystem::path& folder);
  void save_script(const std::filesystem::path& path);
  void run_script(const std::filesystem::path& path);
  /// Fills `costs` for what is looked at now.
  void measure_costs();

  const Scene& scene() const { return now->scene; }
  /// Whether there is something that no file holds: neither the project nor the sources.
  bool unsaved() const;
  /// Active nodes that lie in no other active one.
  std::vector<NodeId> active_tops() const;
  /// Of the active nodes, or of everything visible when none is.
  Box focus() const;
  /// What deforming tools take: the selected triangles, else the first active node, else the first that shows; nothing
  /// in an empty scene.
  std::optional<DeformTarget> deform_target() const;
  /// World box of that.
  Box deform_bounds(const DeformTarget& target) const;
  std::size_t selected_triangles() const { return selected_; }
  void frame_view();

 private:
  void open_project(const std::filesystem::path& path, const Relinked& links);
  void ask_for_sources(const std::filesystem::path& wanted_by, const std::vector<SourcesGone::Source>& gone);

  std::optional<Scene> saved_;  ///< what the project holds
  std::size_t selected_ = 0;
  bool fresh_ = true;  ///< nothing was shown yet: the first scene is framed
};

/// An edit in words: what it does and what it names.
std::string title_of(const Edit& edit, const Scene& scene);

}  // namespace rebake
