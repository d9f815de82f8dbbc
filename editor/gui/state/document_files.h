#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/actions/export_action.h"
#include "editor/edits/nodes/import.h"
#include "editor/gui/state/lost_work.h"
#include "editor/gui/state/messages.h"
#include "editor/gui/state/settings.h"
#include "editor/gui/state/worker.h"

namespace rebake {

/// Files of the document: imports, project file, export, scripts, and recovery of lost work. Starts jobs of the worker;
/// errors are shown as messages.
class Project {
 public:
  /// The references must outlive this object. `opened` is called after a project has been opened.
  Project(Worker& worker, Settings& settings, Messages& messages, const std::shared_ptr<const Snapshot>& now,
          std::function<void()> opened)
      : worker_(worker), settings_(settings), messages_(messages), now_(now), opened_(std::move(opened)) {}

  std::filesystem::path path;        ///< project file; empty until the document is saved or opened
  std::vector<std::string> to_open;  ///< project to open after the question about unsaved work; empty for none
  std::function<void()> after_save;  ///< called once after the next successful save
  Scene imported;                    ///< scene for comparison: after the imports, or as the project was opened
  /// Shows an error message.
  void say_failed(const std::string& problem) { messages_.fail(problem); }
  std::vector<LostWork> recoverable;  ///< entries of the recovery dialog; empty: the dialog is closed
  /// A question for the new paths of sources that a project or journal needs and that were moved, removed or changed.
  struct Relinking {
    struct Source {
      std::filesystem::path path;  ///< path as imported
      std::string trouble;         ///< description of the problem
      std::string now;             ///< new path, as edited in the dialog
    };
    std::filesystem::path needed_by;  ///< the project or journal
    std::vector<Source> sources;
    SourceLinks known;  ///< answers to earlier questions
  };
  std::optional<Relinking> relinking;  ///< the open question, if any

  /// Starts a journal in journal_folder().
  void begin_journal();
  /// Imports folders and scenes. A project must be the only path and replaces the document. If there is unsaved work
  /// and `wanted` is false, only sets `to_open`, so that a dialog asks first.
  /// `options`: how folders are read.
  void open(const std::vector<std::string>& paths, bool wanted = false, const Import& options = {});
  /// Replaces the document by the work of a journal; unsaved work in the document goes to the trash. If sources are
  /// missing, sets `relinking` instead, unless `go_on_without`: then recovers as much as possible.
  void recover(const std::filesystem::path& journal, const SourceLinks& links = {}, bool go_on_without = false);
  /// Opens or recovers again with the answers in `relinking`, and closes the question. `go_on_without`: as for
  /// recover().
  void relink(bool go_on_without);
  void save(const std::filesystem::path& file, Document::OtherProject other = Document::OtherProject::keep_more);
  void save_scene(const std::filesystem::path& folder);
  void export_scene(const ExportAction& action);
  /// Publishes a single-file web page that starts with `camera`, and opens it in the browser.
  void publish(const std::filesystem::path& file, const Camera& camera);
  void save_script(const std::filesystem::path& file);
  void run_script(const std::filesystem::path& file);
  /// Whether the scene differs from the saved project, or from the imports if there is none.
  bool unsaved() const;

 private:
  /// `keeps`: the work that is open goes to the trash. So does work that jobs do before the project is open.
  void open_project(const std::filesystem::path& file, const SourceLinks& links, bool keeps = false);
  void ask_for_sources(const std::filesystem::path& needed_by, const std::vector<SourcesUnavailable::Source>& gone,
                       const SourceLinks& links);

  Worker& worker_;
  Settings& settings_;
  Messages& messages_;
  const std::shared_ptr<const Snapshot>& now_;
  std::function<void()> opened_;
  std::optional<Scene> saved_;     ///< scene in the project file; nothing without a project
  bool cannot_be_opened_ = false;  ///< the project was saved last without a source that it needs
};

}  // namespace rebake
