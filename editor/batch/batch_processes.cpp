#include "editor/batch/batch_processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <utility>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"

extern char** environ;

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Threads per process, so that all processes together have one thread per core.
int threads_of_each(int jobs) { return std::max(1, tbb::this_task_arena::max_concurrency() / jobs); }

}  // namespace

pid_t start_process(const BatchOptions& options, const fs::path& scene, const ProcessFiles& files,
                    const std::string& script_content) {
  std::vector<std::string> words{options.program,
                                 "run",
                                 options.script,
                                 "--scene",
                                 scene.string(),
                                 "--out",
                                 options.out / scene_title(scene),
                                 "--list-files",
                                 files.files_list,
                                 "--protect",
                                 files.sources,
                                 "--script-content",
                                 script_content,
                                 "--threads",
                                 std::to_string(threads_of_each(options.jobs)),
                                 "--parent",
                                 std::to_string(::getpid())};
  for (const std::string& variable : options.variables) words.insert(words.end(), {"--var", variable});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t redirections;
  posix_spawn_file_actions_init(&redirections);
  posix_spawn_file_actions_addopen(&redirections, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&redirections, STDOUT_FILENO, files.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawn_file_actions_adddup2(&redirections, STDOUT_FILENO, STDERR_FILENO);
  pid_t process = 0;
  const int error = posix_spawn(&process, options.program.c_str(), &redirections, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&redirections);
  if (error != 0) throw FileError(options.program, "cannot be started");
  return process;
}

std::string last_error(const fs::path& log, int status) {
  std::string found;
  try {
    const std::string text = read_file(log);
    const std::string mark = "error: ";
    if (const std::size_t at = text.rfind(mark); at != std::string::npos)
      found = text.substr(at + mark.size(), text.find_last_not_of('\n') + 1 - at - mark.size());
  } catch (const FileError&) {
    // There is no log: use the status only.
  }
  if (WIFSIGNALED(status))
    return fmt::format("crashed with signal {}{}{}", WTERMSIG(status), found.empty() ? "" : ": ", found);
  return found.empty() ? fmt::format("failed with exit code {}; see its log", WEXITSTATUS(status)) : found;
}

void Processes::end() {
  for (const auto& [process, job] : jobs_) ::kill(process, SIGINT);
  for (const auto& [process, job] : jobs_) ::waitpid(process, nullptr, 0);
  jobs_.clear();
}

std::optional<Processes::Job> Processes::wait(int& status) {
  const auto ended = jobs_.find(::waitpid(-1, &status, 0));
  if (ended == jobs_.end()) return std::nullopt;
  Job job = std::move(ended->second);
  jobs_.erase(ended);
  return job;
}

}  // namespace rebake
