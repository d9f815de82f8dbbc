#include "editor/gui/state/document_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "editor/actions/publish_action.h"
#include "editor/actions/save.h"
#include "editor/document/journal.h"
#include "editor/document/project.h"
#include "editor/document/replaced_work.h"
#include "editor/gui/platform/default_program.h"
#include "editor/script/script.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Whether nothing that a project keeps differs.
bool same_work(const Scene& a, const Scene& b) {
  const bool same_light = a.light == b.light || (a.light && b.light && *a.light == *b.light);
  return a.roots == b.roots && a.views == b.views && a.background == b.background && a.ground == b.ground &&
         a.camera_keys == b.camera_keys && same_light;
}

// Replaces the session's document. The work that was open goes to the trash if it is to be kept. Returns what became of
// it, for the user; empty: nothing to say.
std::string replace_document(Session& session, Document&& document, bool keeps) {
  const fs::path present = session.document.journal_path();
  if (!keeps) session.document.discard_journal();
  session.document = std::move(document);
  ++session.document_number;
  if (!keeps || present.empty()) return "";
  LostWork open;
  open.journal = present;
  try {
    discard(open);
  } catch (const fs::filesystem_error&) {
    return "the work that was open before is still in " + present.string();
  }
  return "the work that was open before was moved to the trash (File, Discarded work)";
}

// Throws FileError if a file exists that is no script.
void refuse_replacing_other_than_script(const fs::path& file) {
  refuse_replacing_work(file);
  std::error_code error;
  if (!fs::exists(file, error) || (fs::is_regular_file(file, error) && fs::file_size(file, error) == 0)) return;
  const std::string text = with_line_feeds(read_file(file));
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line(command_text(std::string_view(text).substr(at, end - at)));
    at = end + 1;
    if (line.empty()) continue;
    const nlohmann::json first = nlohmann::json::parse(line, nullptr, false);
    if (first.is_object() && first.contains("op")) return;
    break;
  }
  throw FileError(file, "exists and is not a script, so it is not replaced; choose another name");
}

void keep_journal(Document& document) {
  const fs::path folder = journal_folder();
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw FileError(folder, "cannot be created: " + failed.message());
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  document.keep_journal(folder / fmt::format("{}-{}.journal",
                                             std::chrono::duration_cast<std::chrono::milliseconds>(since).count(),
                                             ::getpid()));
}

// Begins a journal if it can. Returns why not, for the user; empty: done.
std::string try_keep_journal(Document& document) {
  try {
    keep_journal(document);
    return "";
  } catch (const Error& error) {
    return fmt::format("there is no crash recovery ({})", error.what());
  }
}

}  // namespace

void Project::begin_journal() {
  worker_.start("journal", [](Session& session) {
    if (const std::string missing = try_keep_journal(session.document); !missing.empty()) throw Error(missing);
  });
}

void Project::open(const std::vector<std::string>& paths, bool wanted, const Import& options) {
  if (paths.size() == 1 && is_project_file(paths.front())) {
    if (unsaved() && !wanted) {
      to_open = paths;
      return;
    }
    open_project(fs::absolute(paths.front()), {});
    return;
  }
  for (const std::string& source : paths) {
    Import import = options;
    import.path = source;
    worker_.start_change(
        "import",
        [import](Session& session) {
          // The first import sets the ground plane at its lowest point.
          Import one = import;
          one.ground = session.scene().roots.empty();
          session.edit(one);
        },
        [this, source] { settings_.remember(absolute_path(source).string()); });
  }
}

void Project::open_project(const fs::path& file, const SourceLinks& links, bool keeps) {
  auto gone = std::make_shared<std::vector<SourcesUnavailable::Source>>();
  auto read = std::make_shared<Scene>();  // later jobs may have changed the document before the window knows it
  worker_.start_change(
      "open",
      [file, links, gone, read, keeps, asked = now_->scene](Session& session) {
        try {
          Document opened = Document::open(file, links, session.progress);
          const std::string missing = try_keep_journal(opened);
          // A job that ran when the user asked may have changed the document since.
          if (const std::string said =
                  replace_document(session, std::move(opened), keeps || !same_work(session.scene(), asked));
              !said.empty())
            session.say(said);
          if (!missing.empty()) session.say(missing);
          *read = session.scene();
        } catch (const SourcesUnavailable& moved) {
          *gone = moved.sources;  // the user is asked for new paths
        }
      },
      [this, file, links, gone, read] {
        if (!gone->empty()) {
          ask_for_sources(file, *gone, links);
          return;
        }
        path = file;
        saved_ = *read;
        cannot_be_opened_ = false;
        imported = *read;
        settings_.remember(file.string());
        opened_();
      },
      {}, Worker::On::any_document);
}

void Project::recover(const fs::path& journal, const SourceLinks& links, bool go_on_without) {
  auto gone = std::make_shared<std::vector<SourcesUnavailable::Source>>();
  auto problem = std::make_shared<std::string>();
  worker_.start_change(
      "recover",
      [journal, links, gone, problem, go_on_without, was_unsaved = unsaved(), asked = now_->scene](Session& session) {
        Document::Recovered recovered = Document::recover(journal, links, session.progress);
        *gone = recovered.gone;
        if (!gone->empty() && !go_on_without) return;  // the user is asked for new paths
        const std::string missing = recovered.document.keeps_journal() ? "" : try_keep_journal(recovered.document);
        // A job that ran when the user asked may have changed the document since.
        const std::string kept =
            replace_document(session, std::move(recovered.document), was_unsaved || !same_work(session.scene(), asked));
        std::string said = counted(recovered.edits, "edit") + " recovered";
        if (!kept.empty()) said += "; " + kept;
        if (!missing.empty()) said += "; " + missing;
        if (recovered.torn) said += "; the last edit was incomplete when the editor ended and is lost";
        if (recovered.skipped_undone > 0)
          said += fmt::format("; {} left out, because a source is missing; {} still holds {}",
                              counted(recovered.skipped_undone, "undone edit was", "undone edits were"),
                              journal.string(), recovered.skipped_undone == 1 ? "it" : "them");
        session.say(said);
        if (recovered.lost.empty()) {
          // Otherwise the new journal holds everything.
          if (recovered.journal && recovered.skipped_undone == 0 && missing.empty()) recovered.journal->discard();
          return;
        }
        *problem = fmt::format("not everything could be recovered; {} was kept:", journal.string());
        for (const std::string& lost : recovered.first_lost()) *problem += "\n" + lost;
      },
      [this, journal, links, gone, problem, go_on_without] {
        if (!gone->empty() && !go_on_without) {
          ask_for_sources(journal, *gone, links);
          return;
        }
        path.clear();
        saved_.reset();
        cannot_be_opened_ = false;
        imported = {};
        if (problem->empty()) return;
        messages_.fail(*problem);
      },
      {}, Worker::On::any_document);
}

void Project::ask_for_sources(const fs::path& needed_by, const std::vector<SourcesUnavailable::Source>& gone,
                              const SourceLinks& links) {
  relinking = Relinking{needed_by, {}, links};
  for (const SourcesUnavailable::Source& source : gone)
    relinking->sources.push_back(
        {source.path, source.trouble, resolved_source(source.path, source.content, links).string()});
}

void Project::relink(bool go_on_without) {
  const Relinking wanted = *std::exchange(relinking, std::nullopt);
  SourceLinks links = wanted.known;
  for (const Relinking::Source& source : wanted.sources) {
    links.erase(source.path);
    if (source.now != source.path.string() && !source.now.empty()) links.emplace(source.path, source.now);
  }
  if (is_project_file(wanted.needed_by)) {
    open_project(wanted.needed_by, links, unsaved());
    return;
  }
  recover(wanted.needed_by, links, go_on_without);
}

void Project::save(const fs::path& file, Document::OtherProject other) {
  auto saved = std::make_shared<Scene>();
  auto written = std::make_shared<SavedProject>();
  worker_.start(
      "saving",
      [file, other, saved, written](Session& session) {
        *written = session.document.save(file, session.progress, other);
        *saved = session.scene();
        // Perhaps the folder of journals can be written by now.
        if (!session.document.keeps_journal())
          if (std::string missing = try_keep_journal(session.document); !missing.empty())
            written->warnings.push_back(missing);
      },
      [this, file, saved, written] {
        path = file;
        settings_.remember(file.string());
        messages_.say("Saved " + file.string());
        for (const std::string& warning : written->warnings) messages_.fail(warning);
        const auto next = std::exchange(after_save, nullptr);
        // The work is lost if the window closes now, because nothing can open the project.
        cannot_be_opened_ = !written->opens;
        if (cannot_be_opened_) return;
        saved_ = *saved;
        if (next) next();
      },
      // After a failed save the follow-up is dropped, so that a later save does not trigger it.
      [this] { after_save = nullptr; });
}

void Project::save_scene(const fs::path& folder) {
  worker_.start("save scene", [folder](Session& session) {
    SaveAction action;
    action.out = folder.string();
    run(session, action);
  });
}

void Project::export_scene(const ExportAction& action) {
  worker_.start("export", [action](Session& session) {
    run(session, action);
    session.drop_renderer();  // frees the copy of the scene on the GPU that measured the loss
  });
}

void Project::publish(const fs::path& file, const Camera& camera) {
  worker_.start(
      "publishing",
      [file, camera](Session& session) {
        PublishAction action;
        action.out = file.string();
        action.single_file = true;
        action.camera = camera;
        run(session, action);
      },
      [file] { open_in_default_program(file); });
}

namespace {

// States the name of the node that a line makes, if it makes one: later lines name it so, and imports of other folders
// would get other names.
void name_made_node(nlohmann::json& line, const Scene& before, const Scene& after) {
  if (!line.contains("as") || line.at("as") != "") return;
  std::vector<std::string> made;
  for (const PlacedNode& placed : placed_nodes(after)) {
    const NodeId parent = parent_of(after, placed.node->id);
    if (!find(before, placed.node->id) && (parent == NodeId::none || find(before, parent)))
      made.push_back(placed.node->name);
  }
  if (made.size() == 1) line["as"] = made.front();
}

}  // namespace

void Project::save_script(const fs::path& file) {
  worker_.start("save script", [file](Session& session) {
    refuse_replacing_other_than_script(file);
    std::string text;
    bool braces = false;
    const History& history = session.document.history();
    const std::vector<Edit> edits = history.edits();
    const std::vector<std::size_t> before = history.edits_before();
    for (std::size_t k = 0; k < edits.size(); ++k) {
      // Nodes by name, because other scenes have other numbers.
      const bool names = !edits[k].type().named_nodes(edits[k].value()).empty(), makes = edits[k].type().makes_nodes;
      nlohmann::json line = to_json(edits[k]);
      if (names || makes) {
        const Scene scene = history.scene_at(before[k], session.progress);
        line = to_json_with_names(edits[k], scene);
        const std::size_t next = k + 1 < edits.size() ? before[k + 1] : history.undo_count();
        if (makes) name_made_node(line, scene, history.scene_at(next, session.progress));
      }
      text += line.dump() + "\n";
      try {
        braces = braces || with_variables(line, {}) != line;
      } catch (const Error&) {
        braces = true;
      }
    }
    write_file_atomically(file, text, session.document.sources());
    session.say("Wrote " + file.string());
    if (braces)
      session.say("Names or paths in the script have braces, which scripts take for variables; rename them first.");
  });
}

void Project::run_script(const fs::path& file) {
  worker_.start_change("script", [file](Session& session) {
    const std::string script = read_input(file);
    // Only while it runs.
    const SourceGuard before = session.document.protections();
    const auto restore = [&] { session.document.restore_protections(before); };
    try {
      session.document.protect_file(file, "the script of this run");
      protect_input_files(session.document, script, {});
      rebake::run_script(session, script, file, {});
    } catch (...) {
      restore();
      throw;
    }
    restore();
  });
}

bool Project::unsaved() const { return cannot_be_opened_ || !same_work(now_->scene, saved_ ? *saved_ : imported); }

}  // namespace rebake
