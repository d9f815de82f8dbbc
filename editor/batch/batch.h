#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Options of a batch: one script over many scenes. Each scene has its own process, so that an error or crash affects
/// no other scene.
struct BatchOptions {
  std::filesystem::path script;
  std::vector<std::string> scenes;     ///< folders, or glob patterns such as scenes/*, with {a,b} and ~
  std::filesystem::path out;           ///< a scene's result goes to out/NAME, unless the script exports
  std::vector<std::string> variables;  ///< name=value, for the script
  int jobs = 1;                        ///< processes at a time
  /// Skip scenes that were done before with the same program, script, variables and input files, if all their outputs
  /// are unchanged.
  bool resume = false;
  /// Run only shard `shard` of 1 … `shards`. A hash of its name assigns a scene to a shard, so that tasks agree even if
  /// they see different lists of scenes.
  int shard = 1, shards = 1;
  std::filesystem::path report;   ///< file to which the caller writes a report; empty for none
  std::filesystem::path program;  ///< executable to run for each scene: rebake itself
};

/// Result of one scene.
struct BatchResult {
  enum class Status { done, skipped, failed };
  std::string name;
  std::filesystem::path scene;
  Status status = Status::failed;
  bool below_requested_psnr = false;  ///< done, but an export missed the PSNR that the script requires
  std::string message;                ///< reason of a failure, or of `below_requested_psnr`
  double seconds = 0;                 ///< duration of the process
};

const char* to_string(BatchResult::Status status);

/// Scenes of a batch.
struct BatchScenes {
  std::vector<std::filesystem::path> shard_scenes;  ///< folders of this shard in the order of their names; may be empty
  /// Paths that scripts must not overwrite: the scenes of all shards, and the inputs of scripts. `first`: name of the
  /// only scene that reads the path and may therefore overwrite it; empty: none.
  std::vector<std::pair<std::string, std::filesystem::path>> protected_paths;
};

/// Matches the patterns and checks all paths. Throws FieldError if a pattern matches nothing, if two scenes have the
/// same name, and if a result would replace its scene or the report. Throws FileError if the script cannot be read.
/// Also throws FileError if the batch's own files or the report would lie in a scene or replace an input of a script.
BatchScenes batch_scenes(const BatchOptions& options);

/// Runs the scenes of this shard and calls `ended` for each when it ends. Returns the results in the order of the
/// scenes. Concurrent shards need a common file system with exclusive creation of files (O_EXCL), such as local ones,
/// NFS 3 and later, or Lustre: it lets them detect that two scenes export to one folder. Throws FieldError and
/// FileError as batch_scenes() does, FileError if the output folder cannot be used, and Cancelled; scenes that are done
/// stay done.
std::vector<BatchResult> run_batch(const BatchOptions& options, const Progress& progress,
                                   const std::function<void(const BatchResult&)>& ended);

}  // namespace rebake
