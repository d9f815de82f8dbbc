#include "editor/gui/window/desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <utility>

#include "editor/commands/views.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/support.h"
#include "editor/gui/view/navigation.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

Desk::Desk(Settings with, std::function<void()> wake)
    : settings(std::move(with)),
      jobs(std::move(wake)),
      now(jobs.worker.snapshot()),
      project(jobs.worker, settings, messages, now, [this] { view.camera = framing_of(scene(), view.aspect()); }) {
  project.begin_journal();
}

void Desk::update() {
  std::vector<Worker::Message> news = jobs.worker.take_messages();
  const bool said = !news.empty();
  for (Worker::Message& message : news) {
    // Of several none is lost.
    if (message.failed) messages.error += (messages.error.empty() ? "" : "\n\n") + message.text;
    messages.log.push_back({std::move(message.text), message.failed});
  }
  // Before the snapshot, which is then at least as new.
  const std::vector<std::function<void()>> finished = jobs.worker.take_finished();
  const std::shared_ptr<const Snapshot> next = jobs.worker.snapshot();
  if (next != now) {
    const bool other = next->scene.roots != scene().roots;
    // The last line tells of the last thing that was done.
    if (!said && next->done.size() > now->done.size())
      messages.log.push_back({title_of(next->done.back(), next->scene)});
    now = next;
    if (other && preview && preview->of != next->scene.roots) preview.reset();
    std::erase_if(active, [&](NodeId id) { return find(scene(), id) == nullptr; });
    if (std::all_of(now->done.begin(), now->done.end(), [](const Edit& one) { return one.is<Import>(); }))
      project.imported = scene();
    selected_ = 0;
    for (const PlacedNode& placed : placed_nodes(scene()))
      if (placed.node->selection) selected_ += count(*placed.node->selection);
    if (fresh_ && !world_bounds(scene()).isEmpty()) {
      fresh_ = false;
      view.camera = framing_of(scene(), view.aspect());
    }
  }
  for (const std::function<void()>& then : finished) {
    try {
      then();
    } catch (const std::exception& problem) {
      messages.error = problem.what();
    }
  }
}

void Desk::edit(const Edit& one) { edits({one}); }

void Desk::edits(const std::vector<Edit>& list, std::function<void()> then) {
  if (list.empty()) return;
  jobs.worker.start(
      list.front().type().op, [list](Session& session) { session.edits(list); },
      [this, then = std::move(then)] {
        preview.reset();
        if (then) then();
      },
      // What was not done is not shown.
      [this] { preview.reset(); });
}

void Desk::undo(int steps) {
  jobs.worker.start("undo", [steps](Session& session) {
    int done = 0;
    while (done < steps && session.document.undo_step(session.progress)) ++done;
    session.say(fmt::format("undone: {}", done));
  });
}
void Desk::redo(int steps) {
  jobs.worker.start("redo", [steps](Session& session) {
    int done = 0;
    while (done < steps && session.document.redo_step(session.progress)) ++done;
    session.say(fmt::format("done again: {}", done));
  });
}

std::vector<NodeId> Desk::active_tops() const {
  std::vector<NodeId> tops;
  for (const NodeId id : active) {
    bool below = false;
    for (NodeId parent = parent_of(scene(), id); parent != NodeId::none && !below; parent = parent_of(scene(), parent))
      below = active.contains(parent);
    if (!below) tops.push_back(id);
  }
  return tops;
}

Box Desk::focus() const {
  Box box;
  for (const NodeId id : active) box.extend(subtree_bounds(scene(), id));
  return box.isEmpty() ? world_bounds(scene()) : box;
}

std::optional<DeformTarget> Desk::deform_target() const {
  DeformTarget target;
  if (selected_triangles() > 0) {
    target.selection = true;
    return target;
  }
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (placed.visible && !placed.locked && placed.node->object &&
        (active.empty() || active.contains(placed.node->id))) {
      target.node = NodeRef{placed.node->id};
      return target;
    }
  return std::nullopt;
}

Box Desk::deform_bounds(const DeformTarget& target) const {
  if (target.node) return subtree_bounds(scene(), target.node->id);
  Box box;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (placed.visible && !placed.locked && placed.node->selection) box.extend(selection_bounds(placed));
  return box;
}

void Desk::frame_view() {
  Box box;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (placed.visible && placed.node->selection) box.extend(selection_bounds(placed));
  view.camera = framed(view.camera, box.isEmpty() ? focus() : box, view.aspect());
}

std::string title_of(const Edit& edit, const Scene& scene) {
  const nlohmann::json object = to_json(edit);
  std::string title = object.at("op").get<std::string>();
  std::replace(title.begin(), title.end(), '_', ' ');
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  if (const auto* transform = edit.as<Transform>()) {
    // What people call it.
    const bool turns = !transform->rotate.matrix().isIdentity(0), scales = transform->scale.value != Vec3::Ones();
    if (!turns && !scales) title = "Move";
    if (turns && !scales) title = "Turn";
    if (!turns && scales) title = "Scale";
    if (transform->selection) title += " triangles of";
  }
  if (object.contains("path")) return title + " " + folder_title(object.at("path").get<std::string>());
  if (object.contains("name") && object.at("name").is_string())
    title += " \"" + object.at("name").get<std::string>() + "\"";
  const auto name = [&](const nlohmann::json& id) {
    if (!id.is_number_unsigned()) return;
    if (const NodePtr node = find(scene, static_cast<NodeId>(id.get<std::uint64_t>()))) title += " " + node->name;
  };
  if (object.contains("node")) name(object.at("node"));
  if (object.contains("nodes") && object.at("nodes").is_array())
    for (const nlohmann::json& id : object.at("nodes")) name(id);
  return title;
}

}  // namespace rebake
