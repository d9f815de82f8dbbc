#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "editor/batch/batch_options.h"
#include "mesh_ops/base/progress.h"

namespace rebake {

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

/// Runs the scenes of this shard and calls `ended` for each when it ends. Returns the results in the order of the
/// scenes. Concurrent shards need a common file system with exclusive creation of files (O_EXCL), such as local ones,
/// NFS 3 and later, or Lustre: it lets them detect that two scenes export to one folder. Throws FieldError and
/// FileError as batch_scenes() does, FileError if the output folder cannot be used, and Cancelled; scenes that are done
/// stay done.
std::vector<BatchResult> run_batch(const BatchOptions& options, const Progress& progress,
                                   const std::function<void(const BatchResult&)>& ended);

}  // namespace rebake
