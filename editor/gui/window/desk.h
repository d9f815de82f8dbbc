#pragma once

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "editor/edits/deform/deforming.h"
#include "editor/edits/select/grow.h"
#include "editor/edits/select/select_connected.h"
#include "editor/edits/select/shrink.h"
#include "editor/edits/shape/delete_selected.h"
#include "editor/gui/tools/tool_state.h"
#include "editor/gui/view/view_state.h"
#include "editor/gui/window/asking.h"
#include "editor/gui/window/jobs.h"
#include "editor/gui/window/messages.h"
#include "editor/gui/window/previews.h"
#include "editor/gui/window/project.h"
#include "editor/gui/window/relighter.h"
#include "editor/gui/window/settings.h"

namespace rebake {

struct SelectPicture;

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
  Previews previews;
  Relighter relighter;
  Jobs jobs;
  std::shared_ptr<const Snapshot> now;
  Project project;
  std::string status;  ///< what was done last, in a sentence

  std::set<NodeId> active;  ///< picked nodes: what panels, gizmos and tools work on
  /// Drawn in place of the scene that it was made of, while something is dragged or typed, and until the job that
  /// carries it out has ended.
  std::optional<Preview> preview;
  /// Has what edits would make of a scene (left out: the present one) shown in its place, as soon as it is made; before
  /// that what `quick` makes, where there is one. Where these very edits are made then, nothing is carried out again.
  void show_preview(std::vector<Edit> list, std::optional<Scene> from = {}, Previews::Make quick = {});
  void drop_preview();
  /// What the viewport draws.
  const Scene& shown() const { return preview && preview->of == scene().roots ? preview->scene : scene(); }

  /// Takes in what the worker did.
  void update();
  /// Whether `now` is what the document holds: nothing was being done when it was taken.
  bool at_rest() const { return at_rest_; }

  /// An edit of triangles, of the picked nodes only where there are some; for edits with a field `node`.
  template <class T>
  void edit_scope(T wanted) {
    std::vector<Edit> list;
    for (const std::optional<NodeRef>& node : scope(needs_selection<T>)) {
      wanted.node = node;
      list.emplace_back(wanted);
    }
    edits(list);
  }
  /// The picked nodes that hold something to select or deform, or one empty entry for all that is visible and not
  /// locked, when none is picked. With `selected` those that hold selected triangles only.
  std::vector<std::optional<NodeRef>> scope(bool selected = false) const;
  /// "in kettle", "in 3 objects", "in all".
  std::string scope_words() const;

  void edit(const Edit& edit);
  /// All of them as one step of history, or none where one fails; `then` once they are done, `otherwise` when they
  /// failed or were stopped.
  void edits(const std::vector<Edit>& list, std::function<void()> then = {}, std::function<void()> otherwise = {});
  /// Like edits(), but records nothing if no node changes; the status line then shows the reports.
  void edits_that_change(const std::vector<Edit>& list);
  /// In place of the last step, which is taken back; where they fail it stays.
  void adjust(const std::vector<Edit>& list, std::function<void()> then = {}, std::function<void()> otherwise = {});
  /// In place of the last step, as a step of its own: undo returns to the last one.
  void revise(const std::vector<Edit>& list, std::function<void()> then = {}, std::function<void()> otherwise = {});
  void undo(int steps = 1);
  void redo(int steps = 1);
  const Scene& scene() const { return now->scene; }
  /// Active nodes that lie in no other active one.
  std::vector<NodeId> active_tops() const;
  /// Of the active nodes, or of everything visible when none is.
  Box focus() const;
  /// What deforming tools take, an edit each: selected triangles (of the picked nodes, where there are some), else the
  /// first picked node, else the first that shows; empty in an empty scene.
  std::vector<DeformTarget> deform_targets() const;
  /// The nodes whose triangles those would move.
  std::set<NodeId> deform_nodes() const;
  /// World box of those.
  Box deform_bounds(const std::vector<DeformTarget>& targets) const;
  /// Number of selected triangles in the scope: those that Delete and other commands change.
  std::size_t selected_triangles() const;
  /// Nodes with selected triangles that commands leave alone: not picked, hidden or locked.
  std::vector<NodeId> selected_out_of_scope() const;
  /// "313 selected in kettle, 9312 elsewhere"; empty if nothing is selected.
  std::string selected_words() const;
  /// The last selecting, where it took in a picture what was seen only; else null.
  const SelectPicture* seen_last() const;
  void frame_view();

 private:
  /// Whether an edit wants selected triangles to be there.
  template <class T>
  static constexpr bool needs_selection = false;
  /// A job that changes the document, for which the present preview stands until it has ended.
  void change(std::string title, Worker::Job job, std::function<void()> then, std::function<void()> otherwise);
  using Replace = void (Session::*)(const std::vector<Edit>&, const CarriedOut*);
  void replace_last(Replace how, const std::vector<Edit>& list, std::function<void()> then,
                    std::function<void()> otherwise);
  void end_preview(std::size_t shown);
  /// Edits that a preview was asked for of, and what it makes of them; null where it made nothing.
  struct Asked {
    std::vector<Edit> list;
    std::shared_future<std::shared_ptr<const CarriedOut>> made;
  };
  /// Those edits as they were asked for last, else nothing.
  std::optional<Asked> asked_for(const std::vector<Edit>& list) const;
  void pick_new(const std::vector<PlacedNode>& before);
  /// Titles of the steps that undoing (negative) or redoing so many passes.
  std::string title_of_steps(int steps) const;
  std::optional<Asked> asked_;
  bool in_scope(const PlacedNode& placed) const;
  std::map<NodeId, std::size_t> selected_;  ///< number of selected triangles, of nodes that have some
  bool at_rest_ = false;
  bool fresh_ = true;  ///< nothing was shown yet: the first scene is framed
};

template <>
inline constexpr bool Desk::needs_selection<Grow> = true;
template <>
inline constexpr bool Desk::needs_selection<Shrink> = true;
template <>
inline constexpr bool Desk::needs_selection<SelectConnected> = true;
template <>
inline constexpr bool Desk::needs_selection<DeleteSelected> = true;

}  // namespace rebake
