#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// One script over many scenes, each in a process of its own, so that what fails or crashes harms no other.
struct BatchOptions {
  std::filesystem::path script;
  std::vector<std::string> scenes;     ///< folders, or patterns such as scenes/* (as of a shell, with {a,b})
  std::filesystem::path out;           ///< a scene's result goes to out/NAME, unless the script exports
  std::vector<std::string> variables;  ///< name=value, for the script
  int jobs = 1;
  bool resume = false;            ///< leave out what was done before with the same program, script, variables and
                                  ///< files, and whose results are still as they were written
  int shard = 1, shards = 1;      ///< scenes fall to shards by their names: each task may see another list of them
  std::filesystem::path report;   ///< where its caller writes a report; empty: nowhere
  std::filesystem::path program;  ///< that is run for each scene: rebake itself
};

struct BatchResult {
  enum class Status { done, skipped, failed };
  std::string name;
  std::filesystem::path scene;
  Status status = Status::failed;
  bool below_asked = false;  ///< done, but an export missed the quality that the script asked for
  std::string message;       ///< why it failed
  double seconds = 0;
};

const char* to_string(BatchResult::Status status);

struct BatchScenes {
  std::vector<std::filesystem::path> mine;  ///< this shard's, by name; none where others have them all
  /// What no script may write over: all scenes, of all shards (first: empty), and what scripts read (first: the scene
  /// whose script alone reads it).
  std::vector<std::pair<std::string, std::filesystem::path>> guarded;
};

/// The folders that the patterns match. Throws FieldError when a pattern matches nothing, when two scenes have one
/// name, and when a result would replace its scene or lie where the report does; FileError when the script cannot be
/// read, and when results or the report would lie in a scene or replace what the script reads.
BatchScenes batch_scenes(const BatchOptions& options);

/// Runs all, and reports each as it ends. Shards that run at one time need a file system that all of them see alike and
/// that makes a file for one of them only (O_EXCL), as local ones, NFS 3 and later, and Lustre do: so they find out
/// when two scenes export to one folder. Results come in the order of the scenes. Throws FileError when the script or
/// the output folder is no good, Cancelled when stopping was asked for (what is done stays done).
std::vector<BatchResult> run_batch(const BatchOptions& options, const Progress& progress,
                                   const std::function<void(const BatchResult&)>& ended);

}  // namespace rebake
