#include "editor/gui/state/document_editor.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "editor/edits/support.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Waits for the result of a preview; null if it failed or was dropped. Throws Cancelled.
std::shared_ptr<const AppliedEdits> wait_for_preview(
    const std::shared_future<std::shared_ptr<const AppliedEdits>>& made, const Progress& progress) {
  constexpr std::chrono::milliseconds look{20};
  while (made.wait_for(look) != std::future_status::ready) progress.at("waiting for the preview", 0);
  try {
    return made.get();
  } catch (const std::future_error&) {
    return nullptr;  // a newer request replaced it before it began
  }
}

}  // namespace

DocumentEditor::DocumentEditor(const std::function<void()>& wake)
    : previews(wake), jobs(wake), now(jobs.worker.snapshot()) {}

Scene DocumentEditor::shown() const {
  Scene result = preview && preview->of == scene().roots ? preview->scene : scene();
  if (beside) result.roots.push_back(beside);
  return result;
}

bool DocumentEditor::take_news() {
  at_rest_ = !jobs.worker.busy();
  std::vector<Worker::Message> news = jobs.worker.take_messages();
  for (Worker::Message& message : news) {
    switch (message.kind) {
      case Worker::Message::Kind::failed:
        messages.fail(std::move(message.text));
        break;
      case Worker::Message::Kind::reported:
        messages.note(std::move(message.text));
        break;
      default:
        messages.say(std::move(message.text));
    }
  }
  // Taken before the snapshot, so that the snapshot is at least as new.
  finished_ = jobs.worker.take_finished();
  const std::shared_ptr<const Snapshot> next = jobs.worker.snapshot();
  if (next == now) return false;
  const bool other = next->scene.roots != scene().roots, other_document = next->document != now->document;
  const bool made_more = !other_document && next->done.size() > now->done.size() &&
                         next->done.back().type().makes_nodes && next->before_last;
  // The status bar shows the title of the last step when it is another one.
  const void* const last_before = now->done.empty() ? nullptr : now->done.back().value();
  if (const void* const last = next->done.empty() ? nullptr : next->done.back().value(); last != last_before)
    status = next->steps_done > 0 ? next->steps[next->steps_done - 1].title : "";
  now = next;
  jobs.worker.saw(*now);
  if ((other && preview && preview->of != next->scene.roots) || other_document) drop_preview();
  // Nodes of another document have the same numbers.
  if (other_document) active.clear();
  std::erase_if(active, [&](NodeId id) { return find(scene(), id) == nullptr; });
  if (made_more) pick_new(placed_nodes(*now->before_last));
  selected_.clear();
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (placed.node->selection)
      if (const std::size_t triangles = count(*placed.node->selection); triangles > 0)
        selected_[placed.node->id] = triangles;
  return true;
}

void DocumentEditor::call_finished() {
  for (const std::function<void()>& then : std::exchange(finished_, {})) {
    try {
      then();
    } catch (const std::exception& problem) {
      messages.fail(problem.what());
    }
  }
  if (std::optional<Preview> made = previews.take(); made && made->of == scene().roots) preview = std::move(made);
}

// Users usually go on with the nodes that were just created.
void DocumentEditor::pick_new(const std::vector<PlacedNode>& before) {
  std::set<NodeId> old;
  for (const PlacedNode& placed : before) old.insert(placed.node->id);
  active.clear();
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (!old.contains(placed.node->id)) active.insert(placed.node->id);
  const std::vector<NodeId> tops = active_tops();
  active = {tops.begin(), tops.end()};
}

std::size_t DocumentEditor::show_preview(std::vector<Edit> list, std::optional<Scene> from, Previews::Make quick) {
  const auto done = std::make_shared<std::promise<std::shared_ptr<const AppliedEdits>>>();
  asked_ = PreviewRequest{list, done->get_future().share(), 0};
  Previews::Make exact = [from = from ? *std::move(from) : scene(), list = std::move(list),
                          done](const Progress& progress) {
    try {
      const auto made = std::make_shared<const AppliedEdits>(apply_edits(from, list, progress));
      done->set_value(made);
      return made->scenes.empty() ? from : made->scenes.back();
    } catch (...) {
      done->set_value(nullptr);
      throw;
    }
  };
  asked_->number = quick ? previews.request(scene().roots, std::move(quick), std::move(exact))
                         : previews.request(scene().roots, std::move(exact));
  return asked_->number;
}

std::optional<DocumentEditor::PreviewRequest> DocumentEditor::matching_preview(const std::vector<Edit>& list) const {
  const auto same = [](const Edit& a, const Edit& b) { return &a.type() == &b.type() && to_json(a) == to_json(b); };
  if (asked_ && std::equal(asked_->list.begin(), asked_->list.end(), list.begin(), list.end(), same)) return asked_;
  return std::nullopt;
}

void DocumentEditor::end_preview(std::size_t shown) {
  if (previews.requests() == shown)
    drop_preview();
  else
    preview.reset();
}

void DocumentEditor::drop_preview() {
  asked_.reset();
  previews.drop();
  preview.reset();
}

void DocumentEditor::edit(const Edit& one) { edits({one}); }

void DocumentEditor::change(std::string title, Worker::Job job, std::function<void()> then,
                            std::function<void()> otherwise) {
  at_rest_ = false;
  const auto ending = [this, shown = previews.requests()](std::function<void()> after) {
    return [this, shown, after = std::move(after)] {
      end_preview(shown);  // also after a failure
      if (after) after();
    };
  };
  jobs.worker.start_change(std::move(title), std::move(job), ending(std::move(then)), ending(std::move(otherwise)));
}

void DocumentEditor::edits(const std::vector<Edit>& list, std::function<void()> then, std::function<void()> otherwise) {
  if (list.empty()) return;
  previews.drop_stale();
  const auto job = [list, asked = matching_preview(list)](Session& session) {
    const auto made = asked ? wait_for_preview(asked->made, session.progress) : nullptr;
    session.edits(list, made.get());
  };
  change(list.front().type().op, job, std::move(then), std::move(otherwise));
}

void DocumentEditor::edits_if_changing(const std::vector<Edit>& list) {
  if (list.empty()) return;
  previews.drop_stale();
  const auto unchanged = std::make_shared<std::string>();
  const auto job = [list, unchanged](Session& session) {
    const AppliedEdits made = apply_edits(session.scene(), list, session.progress);
    std::vector<Edit> changing;
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (made.scenes[k].roots != (k == 0 ? session.scene() : made.scenes[k - 1]).roots) {
        changing.push_back(list[k]);
        continue;
      }
      for (const std::string& line : made.reports[k].lines) *unchanged += (unchanged->empty() ? "" : "; ") + line;
    }
    if (changing.empty()) return;
    if (!unchanged->empty()) session.say(std::exchange(*unchanged, ""));
    session.edits(changing, changing.size() == list.size() ? &made : nullptr);
  };
  change(list.front().type().op, job,
         [this, unchanged] {
           if (!unchanged->empty()) status = *unchanged;
         },
         {});
}

void DocumentEditor::edits_from(std::string title, std::function<std::vector<Edit>(const Scene&)> make,
                                std::function<void()> then, std::function<void()> otherwise) {
  previews.drop_stale();
  change(
      std::move(title), [make = std::move(make)](Session& session) { session.edits(make(session.scene())); },
      std::move(then), std::move(otherwise));
}

void DocumentEditor::edits_unchanged(const std::vector<Edit>& list, std::function<bool(const Scene&)> same,
                                     std::function<void()> then, std::function<void()> otherwise) {
  if (list.empty()) return;
  edits_from(
      list.front().type().op,
      [list, same = std::move(same)](const Scene& scene) {
        if (!same(scene)) throw EditError("another step was applied in the meantime; nothing was changed, try again");
        return list;
      },
      std::move(then), std::move(otherwise));
}

void DocumentEditor::edit_light(const Edit& edit) {
  edit_unchanged(edit, [shown = scene().light](const Scene& on) {
    return on.light == shown || (on.light && shown && *on.light == *shown);
  });
}

void DocumentEditor::adjust(const std::vector<Edit>& list, std::function<void()> then,
                            std::function<void()> otherwise) {
  replace_last(&Session::adjust, list, std::move(then), std::move(otherwise));
}

void DocumentEditor::revise(const std::vector<Edit>& list, std::function<void()> then,
                            std::function<void()> otherwise) {
  replace_last(&Session::revise, list, std::move(then), std::move(otherwise));
}

void DocumentEditor::replace_last(Replace how, const std::vector<Edit>& list, std::function<void()> then,
                                  std::function<void()> otherwise) {
  if (now->done.empty()) return;
  previews.drop_stale();
  const auto job = [how, list, last = now->done.back(), asked = matching_preview(list)](Session& session) {
    const std::vector<Edit> done = session.document.history().edits();
    if (done.empty() || done.back().value() != last.value())
      throw EditError("another step was applied in the meantime; nothing was changed, try again");
    const auto made = asked ? wait_for_preview(asked->made, session.progress) : nullptr;
    (session.*how)(list, made.get());
  };
  change(list.front().type().op, job, std::move(then), std::move(otherwise));
}

namespace {

void undo_step_in(Session& session, DocumentEditor::StepsMade& made) {
  if (!session.document.undo_step(session.progress)) return;
  const History& history = session.document.history();
  ++made.count;
  made.edit = history.entries()[history.undo_count()].edit.value();
}
void redo_step_in(Session& session, DocumentEditor::StepsMade& made) {
  if (!session.document.redo_step(session.progress)) return;
  const History& history = session.document.history();
  ++made.count;
  made.edit = history.entries()[history.undo_count() - 1].edit.value();
}

}  // namespace

void DocumentEditor::undo(int steps) { move_in_history(steps, undo_step_in, "Undid: "); }
void DocumentEditor::redo(int steps) { move_in_history(steps, redo_step_in, "Redid: "); }

void DocumentEditor::move_in_history(int steps, void (*step)(Session&, StepsMade&), const char* did) {
  at_rest_ = false;
  const auto made = std::make_shared<StepsMade>();
  jobs.worker.start_change(
      step == undo_step_in ? "undo" : "redo",
      [steps, step, made](Session& session) {
        for (int before = -1; made->count < steps && before != made->count; step(session, *made)) before = made->count;
      },
      [this, made, did] { status = did + words_of(*made); });
}

std::string DocumentEditor::words_of(const StepsMade& made) const {
  if (made.count == 0) return "nothing";
  return made.count > 1 ? fmt::format("{} steps", made.count) : title_of_step(made.edit);
}

void DocumentEditor::go_to(std::size_t steps) {
  std::vector<Edit> last;  // of each step to be done
  std::vector<std::size_t> edits{0};
  for (std::size_t k = 0; k < std::min(steps, now->steps.size()); ++k) {
    last.push_back(now->steps[k].last);
    edits.push_back(edits.back() + now->steps[k].edits);
  }
  at_rest_ = false;
  const bool undoes = steps < now->steps_done;
  const auto made = std::make_shared<StepsMade>();
  jobs.worker.start_change(
      undoes ? "undo" : "redo",
      [last, edits, made](Session& session) {
        const History& history = session.document.history();
        const std::vector<History::Entry> there = history.entries();
        for (std::size_t k = 0; k < last.size(); ++k)
          if (edits[k + 1] > there.size() || there[edits[k + 1] - 1].edit.value() != last[k].value())
            throw EditError("another step was applied in the meantime; nothing was changed, try again");
        for (int before = -1; history.undo_count() > edits.back() && before != made->count;
             undo_step_in(session, *made))
          before = made->count;
        for (int before = -1; history.undo_count() < edits.back() && before != made->count;
             redo_step_in(session, *made))
          before = made->count;
      },
      [this, made, undoes] {
        if (made->count == 0) return;
        status = (undoes ? "Undid: " : "Redid: ") + words_of(*made);
      });
}

std::string DocumentEditor::title_of_step(const void* edit) const {
  const auto found = std::find_if(now->steps.begin(), now->steps.end(), [&](const Snapshot::Step& step) {
    return step.first.value() == edit || step.last.value() == edit;
  });
  return found == now->steps.end() ? "" : found->title;
}

}  // namespace rebake
