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
#include "editor/gui/state/jobs.h"
#include "editor/gui/state/messages.h"
#include "editor/gui/state/previews.h"

namespace rebake {

struct SelectPicture;

/// The document as the window sees it. The worker owns the document; `now` is a snapshot of it. All changes go through
/// edit(), edits() and their variants, as jobs of the worker.
struct DocumentEditor {
  /// `wake` makes the window draw a frame; it is called from other threads.
  explicit DocumentEditor(const std::function<void()>& wake);
  DocumentEditor(const DocumentEditor&) = delete;
  DocumentEditor& operator=(const DocumentEditor&) = delete;

  Messages messages;
  Previews previews;
  Jobs jobs;
  std::shared_ptr<const Snapshot> now;  ///< latest snapshot of the document
  std::string status;                   ///< text of the status bar: a sentence about the last step

  std::set<NodeId> active;  ///< picked nodes, on which panels, gizmos and tools work
  /// Drawn instead of the document's scene during a drag or while a form is open, and until the job that applies the
  /// edits has ended.
  std::optional<Preview> preview;
  /// Computes the result of edits on `from` (default: the current scene) in the background and shows it as the preview.
  /// `quick` computes an approximation to show first. If the same edits are applied later, this result is reused.
  /// Returns the number of the request.
  std::size_t show_preview(std::vector<Edit> list, std::optional<Scene> from = {}, Previews::Make quick = {});
  /// The number of the request whose preview is shown, or will be when it is computed; 0 for none.
  std::size_t requested_preview() const { return asked_ ? asked_->number : 0; }
  /// Hides the preview and cancels its computation.
  void drop_preview();
  /// A node that is drawn beside the scene, but is not part of the document; null for none.
  NodePtr beside;
  /// The scene that the viewport draws: the preview, if it belongs to the current scene, and `beside`.
  Scene shown() const;

  /// Whether no job was running or waiting when `now` was fetched, so that it equals the document.
  bool at_rest() const { return at_rest_; }

  /// Applies an edit of triangles to each node of scope(), as one step. T has a field `node`.
  template <class T>
  void edit_scope(T wanted) {
    std::vector<Edit> list;
    for (const std::optional<NodeRef>& node : scope(edit_type<T>().needs_selection)) {
      wanted.node = node;
      list.emplace_back(wanted);
    }
    if (list.empty())
      say_why_nothing(edit_type<T>().needs_selection);
    else
      edits(list);
  }
  /// Nodes that commands work on: visible, unlocked nodes with an object that are picked or inside picked groups. With
  /// `selected`, only those with selected triangles. If nothing is picked: one empty entry, which stands for all
  /// visible, unlocked nodes.
  std::vector<std::optional<NodeRef>> scope(bool selected = false) const;
  /// Says that nothing in the scope can be edited, or that nothing is selected there.
  void say_why_nothing(bool needs_selection);
  /// The nodes of scope() by name, also if nothing is picked; empty if there are none.
  std::set<NodeId> nodes_in_scope(bool selected = false) const;
  /// The nodes with selected triangles in scope() if any node is picked, for edits whose empty list means all.
  std::vector<NodeRef> selected_nodes_if_picked() const;
  /// Whether commands work on a node: with an object, visible, not locked, and in a picked node if any is picked.
  /// `in`: its scene, this one or a preview of it.
  bool in_scope(const Scene& in, const PlacedNode& placed) const;
  /// The same for other picks, on any thread.
  static bool in_scope_of(const std::set<NodeId>& picks, const Scene& in, const PlacedNode& placed);
  /// "in kettle", "in 3 picked", "in all".
  std::string scope_words() const;

  /// As edits() with one edit.
  void edit(const Edit& edit);
  /// Applies all edits as one step of history, or none if one fails. Asynchronous: update() calls `then` after success,
  /// `otherwise` after failure or cancellation.
  void edits(const std::vector<Edit>& list, std::function<void()> then = {}, std::function<void()> otherwise = {});
  /// As edits(), but records no step if no node changes; the status bar then shows the edits' reports.
  void edits_if_changing(const std::vector<Edit>& list);
  /// As edits(), with edits that `make` computes from the scene to which they apply; earlier jobs may have changed it
  /// since `now`. If `make` throws, nothing is changed.
  void edits_from(std::string title, std::function<std::vector<Edit>(const Scene&)> make,
                  std::function<void()> then = {}, std::function<void()> otherwise = {});
  /// As edits(), for edits made from a part of the scene in `now`. Nothing is changed, and an error is shown, if `same`
  /// says that this part of the scene, to which they would apply, is another one by then.
  void edits_unchanged(const std::vector<Edit>& list, std::function<bool(const Scene&)> same,
                       std::function<void()> then = {}, std::function<void()> otherwise = {});
  void edit_unchanged(const Edit& edit, std::function<bool(const Scene&)> same) {
    edits_unchanged({edit}, std::move(same));
  }
  /// As edit_unchanged(), for an edit made from the light of the scene in `now`.
  void edit_light(const Edit& edit);
  /// Replaces the last step by these edits. The last step stays if they fail.
  void adjust(const std::vector<Edit>& list, std::function<void()> then = {}, std::function<void()> otherwise = {});
  /// As adjust(), but adds a new step: undo returns to the replaced one.
  void revise(const std::vector<Edit>& list, std::function<void()> then = {}, std::function<void()> otherwise = {});
  void undo(int steps = 1);
  void redo(int steps = 1);
  /// Steps that a job has undone or redone.
  struct StepsMade {
    int count = 0;
    const void* edit = nullptr;  ///< address of the first or last edit of the last of these steps
  };
  /// Undoes or redoes until this number of the steps in `now` is done; does nothing, with an error, if there are other
  /// steps by then.
  void go_to(std::size_t steps);
  const Scene& scene() const { return now->scene; }
  /// Picked nodes without those inside other picked nodes.
  std::vector<NodeId> active_tops() const;
  /// World box of the picked nodes; of everything visible if nothing is picked.
  Box focus() const;
  /// Targets of deformation tools, one edit per target: the selected triangles in scope(), else the picked nodes with
  /// visible, unlocked objects (the only such root if nothing is picked). Empty if there is none. `moved` gets the
  /// nodes whose triangles would move.
  std::vector<DeformTarget> deform_targets(std::set<NodeId>* moved = nullptr) const;
  /// The target of a tool that makes one edit: that of deform_targets(), or all selected triangles of the scene if
  /// those are the targets. Nothing, and a message, if there is no target or several that one edit cannot name.
  std::optional<DeformTarget> one_deform_target();
  /// Nodes whose triangles deform_targets() would move.
  std::set<NodeId> deform_nodes() const;
  /// World box of the targets' triangles.
  Box deform_bounds(const std::vector<DeformTarget>& targets) const;
  /// Number of selected triangles in scope(), which Delete and other commands change.
  std::size_t selected_triangles() const;
  /// Nodes outside scope() that have selected triangles: not picked, hidden or locked.
  std::vector<NodeId> selected_out_of_scope() const;
  /// "313 selected in kettle, 12 hidden or locked, 9312 elsewhere"; empty if nothing is selected.
  std::string selected_words() const;
  /// The selecting edits that made the present selection, if all of them selected visible triangles in a picture; else
  /// nothing.
  std::vector<SelectPicture> visible_selections() const;
  /// Their number.
  std::size_t visible_selection_count() const;

 protected:
  /// Fetches messages and the latest snapshot. Returns whether the snapshot is another one.
  bool take_news();
  /// Calls the callbacks of the jobs that had ended before take_news(), and fetches the latest preview.
  void call_finished();

 private:
  /// Starts a job that changes the document. The current preview is shown until the job has ended.
  void change(std::string title, Worker::Job job, std::function<void()> then, std::function<void()> otherwise);
  using Replace = void (Session::*)(const std::vector<Edit>&, const AppliedEdits*);
  void replace_last(Replace how, const std::vector<Edit>& list, std::function<void()> then,
                    std::function<void()> otherwise);
  /// Removes the preview of an ended job; `shown`: previews.requests() at the job's start. Newer requests go on.
  void end_preview(std::size_t shown);
  /// A requested preview: its edits, and their result when computed. The result is null if the edits failed.
  struct PreviewRequest {
    std::vector<Edit> list;
    std::shared_future<std::shared_ptr<const AppliedEdits>> made;
    std::size_t number = 0;
  };
  /// The requested preview, if it has these edits.
  std::optional<PreviewRequest> matching_preview(const std::vector<Edit>& list) const;
  /// Picks the nodes that are not in `before`.
  void pick_new(const std::vector<PlacedNode>& before);
  /// Undoes or redoes up to `steps` steps by `step`. `did`: start of the status text.
  void move_in_history(int steps, void (*step)(Session&, StepsMade&), const char* did);
  /// The title of one step, or "N steps".
  std::string words_of(const StepsMade& made) const;
  /// Title of the step whose first or last edit this is; empty if there is none.
  std::string title_of_step(const void* edit) const;
  std::optional<PreviewRequest> asked_;  ///< the last requested preview
  bool in_scope(const PlacedNode& placed) const { return in_scope(scene(), placed); }
  /// Whether it is in a picked node, or nothing is picked.
  static bool is_picked(const std::set<NodeId>& picks, const Scene& in, NodeId node);
  std::map<NodeId, std::size_t> selected_;  ///< number of selected triangles per node, without zeros
  bool at_rest_ = false;
  std::vector<std::function<void()>> finished_;  ///< callbacks of ended jobs
};

}  // namespace rebake
