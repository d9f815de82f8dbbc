#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/values.h"
#include "editor/gui/window/lost_work.h"
#include "editor/gui/window/messages.h"
#include "editor/gui/window/settings.h"
#include "editor/gui/window/worker.h"
#include "mesh_ops/features/fuse_way.h"

namespace rebake {

/// What the document is on disk: where it came from, where it is saved, and what is to be got back.
class Project {
 public:
  /// All of these outlive it. `opened` is called when another document is there.
  Project(Worker& worker, Settings& settings, Messages& messages, const std::shared_ptr<const Snapshot>& now,
          std::function<void()> opened)
      : worker_(worker), settings_(settings), messages_(messages), now_(now), opened_(std::move(opened)) {}

  std::filesystem::path path;        ///< empty until it has been saved
  std::vector<std::string> to_open;  ///< a project that waits for people's word
  std::function<void()> saved_then;  ///< once the project is saved
  Scene imported;                    ///< as it was before anything but imports was done, or as a project was opened
  /// Shows a failure as messages do.
  void say_failed(const std::string& problem) { messages_.fail(problem); }
  std::vector<LostWork> recoverable;  ///< what the recovery dialog lists; empty when it is closed
  /// Sources that a project or journal wants, and that are not where they were.
  struct Relinking {
    struct Source {
      std::filesystem::path path;
      std::string trouble;
      std::string now;  ///< where people say it is
    };
    std::filesystem::path wanted_by;
    std::vector<Source> sources;
    Relinked known;  ///< what was said before
  };
  std::optional<Relinking> relinking;

  /// Keeps the work safe from the first edit on.
  void begin_journal();
  /// Imports folders and scenes. A project, which must be the only path, takes the place of the document; with unsaved
  /// work in it, people are asked first unless it is `wanted` so.
  void open(const std::vector<std::string>& paths, bool wanted = false);
  /// Gets a journal's work back. Where sources are gone, people are asked for them first.
  void recover(const std::filesystem::path& journal, const Relinked& links = {}, bool go_on_without = false);
  /// With what `relinking` says: opens or recovers again. Without them: as far as a journal goes.
  void relink(bool go_on_without);
  void save(const std::filesystem::path& file);
  void save_scene(const std::filesystem::path& folder);
  /// How one plain folder is wanted, as ExportAction says.
  struct PlainChoice {
    FuseWidth width;
    std::optional<FuseWay> way;
  };
  /// Only `nodes`, where there are some; as one plain folder where that is wanted.
  void export_to(const std::filesystem::path& folder, const std::vector<NodeRef>& nodes = {},
                 const std::optional<PlainChoice>& plain = {});
  void save_script(const std::filesystem::path& file);
  void run_script(const std::filesystem::path& file);
  /// Whether there is something that no file holds: neither the project nor the sources.
  bool unsaved() const;

 private:
  void open_project(const std::filesystem::path& file, const Relinked& links);
  void ask_for_sources(const std::filesystem::path& wanted_by, const std::vector<SourcesGone::Source>& gone,
                       const Relinked& links);

  Worker& worker_;
  Settings& settings_;
  Messages& messages_;
  const std::shared_ptr<const Snapshot>& now_;
  std::function<void()> opened_;
  std::optional<Scene> saved_;  ///< what the project holds
};

}  // namespace rebake
