#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "editor/batch/batch_options.h"
#include "mesh_ops/base/file_lock.h"

namespace rebake {

/// Files of a scene's process.
struct ProcessFiles {
  std::filesystem::path log, files_list;  ///< that it writes: its output, and its list of files
  std::filesystem::path sources;          ///< list of the paths that it must not write
};

/// Starts `rebake run` for a scene. `script_content`: hash of the script. Throws FileError.
pid_t start_process(const BatchOptions& options, const std::filesystem::path& scene, const ProcessFiles& files,
                    const std::string& script_content);

/// Error message of a failed process, from its log or its exit status.
std::string last_error(const std::filesystem::path& log, int status);

/// Running processes. The destructor interrupts them (SIGINT) and waits for them, for a batch that ends early.
class Processes {
 public:
  struct Job {
    std::size_t scene;
    std::string key, inputs;  ///< of the scene, its script and their files before the process started
    std::chrono::steady_clock::time_point since;
    std::unique_ptr<FileLock> lock;  ///< of the scene's result
  };
  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  ~Processes() { end(); }
  /// Interrupts all processes and waits for them.
  void end();
  std::size_t size() const { return jobs_.size(); }
  void add(pid_t process, Job job) { jobs_.emplace(process, std::move(job)); }
  /// Waits until a process ends, and sets its `status`. Returns nothing if a signal interrupts the wait.
  std::optional<Job> wait(int& status);

 private:
  std::map<pid_t, Job> jobs_;
};

}  // namespace rebake
