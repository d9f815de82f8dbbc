#include "editor/gui/window/desk.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "editor/commands/export.h"
#include "editor/commands/save.h"
#include "editor/commands/views.h"
#include "editor/document/project.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/support.h"
#include "editor/gui/view/navigation.h"
#include "editor/script/script.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

void keep_journal(Document& document) {
  const fs::path folder = journal_folder();
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw FileError(folder, "cannot be made, so work is not kept safe: " + failed.message());
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  document.keep_journal(folder / fmt::format("{}-{}.journal",
                                             std::chrono::duration_cast<std::chrono::milliseconds>(since).count(),
                                             ::getpid()));
}

}  // namespace

Desk::Desk(Settings with, std::function<void()> wake)
    : settings(std::move(with)), worker(std::move(wake)), now(worker.snapshot()) {
  worker.start("journal", [](Session& session) { keep_journal(session.document); });
}

void Desk::update() {
  std::vector<Worker::Message> messages = worker.take_messages();
  const bool said = !messages.empty();
  for (Worker::Message& message : messages) {
    // Of several none is lost.
    if (message.failed) error += (error.empty() ? "" : "\n\n") + message.text;
    log.push_back({std::move(message.text), message.failed});
  }
  // Before the snapshot, which is then at least as new.
  const std::vector<std::function<void()>> finished = worker.take_finished();
  const std::shared_ptr<const Snapshot> next = worker.snapshot();
  if (next != now) {
    const bool other = next->scene.roots != scene().roots;
    // The last line tells of the last thing that was done.
    if (!said && next->done.size() > now->done.size()) log.push_back({title_of(next->done.back(), next->scene)});
    now = next;
    if (other && preview && preview->of != next->scene.roots) preview.reset();
    std::erase_if(active, [&](NodeId id) { return find(scene(), id) == nullptr; });
    if (std::all_of(now->done.begin(), now->done.end(), [](const Edit& one) { return one.is<Import>(); }))
      imported = scene();
    selected_ = 0;
    for (const PlacedNode& placed : placed_nodes(scene()))
      if (placed.node->selection) selected_ += count(*placed.node->selection);
    if (fresh_ && !world_bounds(scene()).isEmpty()) {
      fresh_ = false;
      camera = framing_of(scene(), static_cast<double>(view_width) / view_height);
    }
  }
  for (const std::function<void()>& then : finished) {
    try {
      then();
    } catch (const std::exception& problem) {
      error = problem.what();
    }
  }
}

void Desk::edit(const Edit& one) { edits({one}); }

void Desk::edits(const std::vector<Edit>& list, std::function<void()> then) {
  if (list.empty()) return;
  worker.start(
      list.front().type().op, [list](Session& session) { session.edits(list); },
      [this, then = std::move(then)] {
        preview.reset();
        if (then) then();
      },
      // What was not done is not shown.
      [this] { preview.reset(); });
}

void Desk::undo(int steps) {
  worker.start("undo", [steps](Session& session) {
    int done = 0;
    while (done < steps && session.document.undo_step(session.progress)) ++done;
    session.say(fmt::format("undone: {}", done));
  });
}
void Desk::redo(int steps) {
  worker.start("redo", [steps](Session& session) {
    int done = 0;
    while (done < steps && session.document.redo_step(session.progress)) ++done;
    session.say(fmt::format("done again: {}", done));
  });
}

void Desk::open(const std::vector<std::string>& paths, bool wanted) {
  if (paths.size() == 1 && is_project_file(paths.front())) {
    if (unsaved() && !wanted) {
      to_open = paths;
      return;
    }
    open_project(fs::absolute(paths.front()), {});
    return;
  }
  for (const std::string& path : paths) {
    Import import;
    import.path = path;
    worker.start(
        "import", [import](Session& session) { session.edit(import); },
        [this, path] { settings.remember(absolute_path(path).string()); });
  }
}

void Desk::open_project(const fs::path& path, const Relinked& links) {
  auto gone = std::make_shared<std::vector<SourcesGone::Source>>();
  worker.start(
      "open",
      [path, links, gone](Session& session) {
        try {
          Document opened = Document::open(path, links, session.progress);
          keep_journal(opened);
          session.document.discard_journal();
          session.document = std::move(opened);
        } catch (const SourcesGone& moved) {
          *gone = moved.sources;  // asked for
        }
      },
      [this, path, gone] {
        if (!gone->empty()) {
          ask_for_sources(path, *gone);
          return;
        }
        project = path;
        saved_ = scene();
        imported = scene();
        camera = framing_of(scene(), static_cast<double>(view_width) / view_height);
        settings.remember(path.string());
      });
}

void Desk::recover(const fs::path& journal, const Relinked& links, bool go_on_without) {
  auto gone = std::make_shared<std::vector<SourcesGone::Source>>();
  worker.start(
      "recover",
      [journal, links, gone, go_on_without](Session& session) {
        Document::Recovered recovered = Document::recover(journal, links, session.progress);
        *gone = recovered.gone;
        if (!gone->empty() && !go_on_without) return;  // asked for
        if (!recovered.document.keeps_journal()) keep_journal(recovered.document);
        session.document.discard_journal();
        session.document = std::move(recovered.document);
        std::string said = fmt::format("{} edits recovered", recovered.edits);
        if (recovered.torn) said += "; one more was being made when the editor ended: it is lost";
        session.say(said);
        if (recovered.lost.empty()) {
          // The new journal holds it all.
          if (recovered.journal) recovered.journal->discard();
          return;
        }
        said = fmt::format("not all could be got back; {} keeps what there is:", journal.string());
        for (const std::string& lost : recovered.lost) said += "\n" + lost;
        throw Error(said);
      },
      [this, journal, gone, go_on_without] {
        if (!gone->empty() && !go_on_without) {
          ask_for_sources(journal, *gone);
          return;
        }
        project.clear();
        saved_.reset();
        imported = {};
      });
}

void Desk::ask_for_sources(const fs::path& wanted_by, const std::vector<SourcesGone::Source>& gone) {
  relinking = Relinking{wanted_by, {}};
  for (const SourcesGone::Source& source : gone)
    relinking->sources.push_back({source.path, source.trouble, source.path.string()});
}

void Desk::relink(bool go_on_without) {
  const Relinking wanted = *std::exchange(relinking, std::nullopt);
  Relinked links;
  for (const Relinking::Source& source : wanted.sources)
    if (source.now != source.path.string() && !source.now.empty()) links[source.path] = source.now;
  if (is_project_file(wanted.wanted_by)) {
    open_project(wanted.wanted_by, links);
    return;
  }
  recover(wanted.wanted_by, links, go_on_without);
}

void Desk::save_project(const fs::path& path) {
  auto saved = std::make_shared<Scene>();
  worker.start(
      "save",
      [path, saved](Session& session) {
        session.document.save(path, session.progress);
        *saved = session.scene();
      },
      [this, path, saved] {
        project = path;
        saved_ = *saved;
        settings.remember(path.string());
        log.push_back({"saved " + path.string()});
      });
}

void Desk::save_scene(const fs::path& folder) {
  worker.start("save scene", [folder](Session& session) {
    SaveAction action;
    action.out = folder.string();
    run(session, action);
  });
}

void Desk::export_to(const fs::path& folder) {
  worker.start("export", [folder](Session& session) {
    ExportAction action;
    action.out = folder.string();
    run(session, action);
  });
}

void Desk::save_script(const fs::path& path) {
  std::string text;
  for (const Edit& one : now->done) text += to_json(one).dump() + "\n";
  worker.start("save script", [path, text](Session& session) {
    write_file_atomically(path, text, session.document.sources());
    session.say("saved " + path.string());
  });
}

void Desk::run_script(const fs::path& path) {
  worker.start("script", [path](Session& session) { rebake::run_script(session, read_input(path), path, {}); });
}

void Desk::measure_costs() {
  auto measured = std::make_shared<Costs>();
  measured->view = {camera, view_width, view_height, 4};
  measured->roots = scene().roots;
  measured->background = scene().background;
  worker.start(
      "measure",
      [measured](Session& session) {
        constexpr int frames = 3;  // the median counts
        const StudyInput input{[&session]() -> Renderer& { return session.renderer(); }, session.scene(),
                               measured->view, frames, session.progress};
        for (const auto study : {study_samples, study_resolution})
          for (StudyTable::Row& row : study(input).rows) measured->rows.push_back(std::move(row));
        measured->device = session.renderer().device();
        session.drop_renderer();  // a second copy of the scene on the GPU
      },
      [this, measured] { costs = measured; });
}

bool Desk::unsaved() const {
  const Scene& kept = saved_ ? *saved_ : imported;
  return scene().roots != kept.roots || scene().views != kept.views || scene().background != kept.background;
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
  camera = framed(camera, box.isEmpty() ? focus() : box, static_cast<double>(view_width) / view_height);
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
