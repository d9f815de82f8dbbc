#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "editor/edits/deform/deforming.h"
#include "editor/gui/tools/tool_state.h"
#include "editor/gui/view/view_state.h"
#include "editor/gui/window/asking.h"
#include "editor/gui/window/jobs.h"
#include "editor/gui/window/messages.h"
#include "editor/gui/window/project.h"
#include "editor/gui/window/settings.h"

namespace rebake {

/// What the window shows beside the document: panels, tools and commands act upon it, each on the part that it needs.
/// What people make is in the document, which the worker owns; `now` is a copy.
struct Desk {
  explicit Desk(Settings with, std::function<void()> wake);
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  Settings settings;
  ViewState view;
  ToolState tools;
  Messages messages;
  Asking asking;
  Jobs jobs;
  std::shared_ptr<const Snapshot> now;
  Project project;

  std::set<NodeId> active;  ///< nodes that panels and gizmos work on
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

  /// Takes in what the worker did.
  void update();

  void edit(const Edit& edit);
  /// All of them as one step of history, or none where one fails; `then` once they are done.
  void edits(const std::vector<Edit>& list, std::function<void()> then = {});
  void undo(int steps = 1);
  void redo(int steps = 1);
  const Scene& scene() const { return now->scene; }
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
  std::size_t selected_ = 0;
  bool fresh_ = true;  ///< nothing was shown yet: the first scene is framed
};

/// An edit in words: what it does and what it names.
std::string title_of(const Edit& edit, const Scene& scene);

}  // namespace rebake
