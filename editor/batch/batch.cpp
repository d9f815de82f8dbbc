#include "editor/batch/batch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <glob.h>
#include <spawn.h>
#include <sys/wait.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "editor/batch/batch_claims.h"
#include "editor/batch/batch_mark.h"
#include "editor/document/sources.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

extern char** environ;

namespace rebake {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

// Name of a scene's result: that of its folder, or of its file without the extension.
std::string scene_title(const fs::path& scene) {
  std::error_code error;
  return fs::is_regular_file(scene, error) ? scene.stem().string() : folder_title(scene);
}

// Folder of the batch's own files: per scene a mark when it is done, and the log of its process.
fs::path state_folder(const BatchOptions& options) { return options.out / ".rebake-batch"; }

// The script's variables for a scene.
std::map<std::string, std::string> variables_of(const BatchOptions& options, const fs::path& scene) {
  std::map<std::string, std::string> variables;
  for (const std::string& variable : options.variables)
    variables[variable.substr(0, variable.find('='))] = variable.substr(variable.find('=') + 1);
  variables["name"] = scene_title(scene);
  variables["path"] = scene.string();
  return variables;
}

// Hash of the inputs of a result: version, program, script, scene, variables and the working folder, from which the
// script's paths start, but not files that the script names. A scene that was done with the same key need not run
// again.
std::string key_of(const BatchOptions& options, std::uint64_t program, std::uint64_t script, const fs::path& scene) {
  std::string all = fmt::format("{} {:016x} {:016x} {:016x}", REBAKE_VERSION, program, script, content_hash_at(scene));
  all += '\n' + fs::current_path().string();
  for (const std::string& variable : options.variables) all += '\n' + variable;
  return hash_text(content_hash(all));
}

// Hash of the list of files that the script would read for a scene: a file that is added, such as a mask, has no
// content in an earlier list of files.
std::string inputs_key(const BatchOptions& options, const fs::path& scene) {
  std::string all;
  for (const ScriptInput& input : script_inputs(read_file(options.script), variables_of(options, scene)))
    all += input.path.string() + '\n';
  return '-' + hash_text(content_hash(all));
}

void set_quality_message(BatchResult& result, bool below_requested_psnr) {
  result.below_requested_psnr = below_requested_psnr;
  if (below_requested_psnr) result.message = "an export is below the requested psnr; the log names the worst object";
}

// Threads per process, so that all processes together have one thread per core.
int threads_of_each(int jobs) { return std::max(1, tbb::this_task_arena::max_concurrency() / jobs); }

pid_t start(const BatchOptions& options, const fs::path& scene, const fs::path& log, const fs::path& files_list,
            const fs::path& sources, const std::string& script_content) {
  std::vector<std::string> words{options.program,
                                 "run",
                                 options.script,
                                 "--scene",
                                 scene.string(),
                                 "--out",
                                 options.out / scene_title(scene),
                                 "--list-files",
                                 files_list,
                                 "--protect",
                                 sources,
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
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  pid_t process = 0;
  const int error = posix_spawn(&process, options.program.c_str(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw FileError(options.program, "cannot be started");
  return process;
}

// Running processes. The destructor interrupts them (SIGINT) and waits for them, for a batch that ends early.
class Processes {
 public:
  struct Job {
    std::size_t scene;
    std::string key, inputs;  // inputs: inputs_key() before the process started
    Clock::time_point since;
    std::unique_ptr<FileLock> lock;  // of the scene's result
  };
  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  ~Processes() { end(); }
  // Interrupts all processes and waits for them.
  void end() {
    for (const auto& [process, job] : jobs_) ::kill(process, SIGINT);
    for (const auto& [process, job] : jobs_) ::waitpid(process, nullptr, 0);
    jobs_.clear();
  }
  std::size_t size() const { return jobs_.size(); }
  void add(pid_t process, Job job) { jobs_.emplace(process, std::move(job)); }
  // Waits until a process ends, and sets its `status`. Returns nothing if a signal interrupts the wait.
  std::optional<Job> wait(int& status) {
    const auto ended = jobs_.find(::waitpid(-1, &status, 0));
    if (ended == jobs_.end()) return std::nullopt;
    Job job = std::move(ended->second);
    jobs_.erase(ended);
    return job;
  }

 private:
  std::map<pid_t, Job> jobs_;
};

// Error message of a failed process, from its log or its exit status.
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

}  // namespace

const char* to_string(BatchResult::Status status) {
  static const char* const names[] = {"done", "skipped", "failed"};
  return names[static_cast<int>(status)];
}

namespace {

using ScenesByName = std::map<std::string, fs::path>;

ScenesByName matched_scenes(const BatchOptions& options) {
  ScenesByName by_name;
  const fs::path out = fs::weakly_canonical(options.out);
  for (const std::string& pattern : options.scenes) {
    std::vector<fs::path> found;
    if (std::error_code error; fs::exists(pattern, error)) {
      found.emplace_back(pattern);  // the name of a scene may contain wildcard characters
    } else {
      glob_t matches{};
      if (::glob(pattern.c_str(), GLOB_BRACE | GLOB_TILDE, nullptr, &matches) == 0)
        found.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
      ::globfree(&matches);
    }
    if (found.empty())
      throw FieldError("--scenes", fmt::format("\"{}\" matches no file or folder; check the pattern", pattern));
    std::vector<fs::path> folders;
    for (fs::path& path : found) {
      if (!path.has_filename()) path = path.parent_path();
      // Skip other files than meshes, and the output folder, which may be among the scenes.
      if ((fs::is_directory(path) || format_at(path) != nullptr) && fs::weakly_canonical(path) != out)
        folders.push_back(path);
    }
    for (const fs::path& folder : folders) {
      if (fs::weakly_canonical(out / scene_title(folder)) == fs::weakly_canonical(folder))
        throw FieldError("--out", fmt::format("the result of {} would replace the scene itself; choose another folder",
                                              folder.string()));
      if (!options.report.empty() &&
          fs::weakly_canonical(options.report) == fs::weakly_canonical(out / scene_title(folder)))
        throw FieldError(
            "--report", fmt::format("the result of {} would replace the report; choose another file", folder.string()));
      const auto [other, added] = by_name.emplace(scene_title(folder), folder);
      if (!added && fs::weakly_canonical(other->second) != fs::weakly_canonical(folder))
        throw FieldError(
            "--scenes",
            fmt::format(
                "{} and {} have the same folder name, so their results would collide; run them in separate batches",
                other->second.string(), folder.string()));
    }
  }
  if (by_name.empty()) throw FieldError("--scenes", "matches no scene; check the patterns");
  return by_name;
}

// Content of the list of a scene that an earlier version did not finish.
constexpr const char* unknown_outputs = "unknown\n";

// Marks the state folders in which a log alone does not tell that a batch wrote a result.
fs::path state_version_file(const BatchOptions& options) { return state_folder(options) / "version-2"; }

// The outputs of a scene that are known: of its last run that ended well, and of a run after it that did not.
std::vector<BatchMark::File> known_outputs(const BatchOptions& options, const std::string& name) {
  const fs::path state = state_folder(options);
  const BatchMark done = read_mark(state / (name + ".done"), options.out);
  if (fs::exists(state / (name + ".done"))) return done.wrote;
  return latest_outputs(read_mark(state / (name + ".unfinished"), options.out),
                        read_mark(state / (name + ".files"), options.out));
}

// Whether a batch wrote the result of this name: it, or something in it, is listed as written; or the batch was one of
// an earlier version, which kept no lists. The folder may have been moved since.
bool written_by_batch(const BatchOptions& options, const std::string& name) {
  const fs::path state = state_folder(options), result = fs::weakly_canonical(options.out / name);
  if (!fs::exists(state_version_file(options)))
    return fs::exists(state / (name + ".log")) || fs::exists(state / (name + ".done"));
  if (fs::exists(state / (name + ".unfinished")) && read_file(state / (name + ".unfinished")) == unknown_outputs)
    return true;
  const std::vector<BatchMark::File> wrote = known_outputs(options, name);
  return std::any_of(wrote.begin(), wrote.end(), [&](const BatchMark::File& file) {
    const fs::path path = fs::weakly_canonical(file.path);
    if (std::mismatch(result.begin(), result.end(), path.begin(), path.end()).first == result.end()) return true;
    return path.filename() == result.filename() && is_unchanged({result.string(), file.content});
  });
}

// Refuses to replace scenes that no batch wrote, and what links refer to.
void check_results(const BatchOptions& options, const ScenesByName& scenes) {
  for (const auto& [name, folder] : scenes) {
    const fs::path result = options.out / name;
    std::error_code error;
    if (fs::is_symlink(result, error))
      throw FieldError(
          "--out", fmt::format("{} is a link, whose target would be replaced; choose another folder", result.string()));
    // A scene that is being processed, or whose last run was killed, is checked when its turn comes.
    if (fs::exists(state_folder(options) / (name + ".unfinished"), error)) continue;
    if (fs::exists(result, error) && !written_by_batch(options, name))
      throw FieldError("--out", fmt::format("{} exists, but no batch wrote it; move it away, or choose another folder",
                                            result.string()));
  }
}

// See BatchScenes::guarded.
std::vector<std::pair<std::string, fs::path>> guarded_by(const BatchOptions& options, const ScenesByName& scenes) {
  const std::string script = read_file(options.script);
  std::vector<std::pair<std::string, fs::path>> protected_paths;
  std::map<fs::path, std::set<std::string>> readers;
  for (const auto& [name, folder] : scenes) {
    protected_paths.emplace_back("", fs::absolute(folder));
    for (const ScriptInput& input : script_inputs(script, variables_of(options, folder)))
      readers[fs::absolute(input.path)].insert(name);
  }
  for (const auto& [path, names] : readers) protected_paths.emplace_back(names.size() == 1 ? *names.begin() : "", path);
  return protected_paths;
}

}  // namespace

BatchScenes batch_scenes(const BatchOptions& options) {
  const ScenesByName by_name = matched_scenes(options);
  check_results(options, by_name);
  BatchScenes result;
  result.protected_paths = guarded_by(options, by_name);
  SourceGuard sources;
  for (const auto& [reader, path] : result.protected_paths) protect_input(sources, path);
  for (const fs::path& kept : {state_folder(options), state_folder(options) / "claims"}) sources.check_file(kept);
  if (format_at(options.out) != nullptr)
    throw FieldError("--out",
                     fmt::format("{} is a scene; choose another folder for the results", options.out.string()));
  if (const fs::path script = fs::weakly_canonical(options.script), state = fs::weakly_canonical(state_folder(options));
      std::mismatch(state.begin(), state.end(), script.begin(), script.end()).first == state.end())
    throw FieldError("script",
                     fmt::format("is in {}, the folder of the batch's own files; move it elsewhere", state.string()));
  if (!options.report.empty()) {
    sources.check_file(options.report);
    if (fs::weakly_canonical(options.report) == fs::weakly_canonical(options.script))
      throw FieldError("--report", "is the script itself; choose another file");
  }
  const auto shards = static_cast<std::uint64_t>(options.shards);
  for (const auto& [name, folder] : by_name)
    if (content_hash(name) % shards == static_cast<std::uint64_t>(options.shard - 1))
      result.shard_scenes.push_back(folder);
  return result;
}

namespace {

// Runs the scenes of one shard, several at a time, as processes of their own.
class BatchRun {
 public:
  BatchRun(const BatchOptions& options, const Progress& progress, const std::function<void(const BatchResult&)>& ended)
      : options_(options),
        progress_(progress),
        ended_(ended),
        program_(content_hash(read_file(options.program))),
        script_(content_hash(read_file(options.script))) {
    BatchScenes found = batch_scenes(options);
    scenes_ = std::move(found.shard_scenes);
    results_.resize(scenes_.size());
    std::error_code error;
    fs::create_directories(state_folder(options), error);
    if (error) throw FileError(options.out, "cannot be created: " + error.message());
    keep_results_of_earlier_versions();
    // No script may overwrite another scene or an input of another script.
    std::string list;
    for (const auto& [reader, path] : found.protected_paths) list += reader + '\0' + path.string() + '\0';
    // A unique name, since another batch with the same output folder has other scenes.
    sources_ = state_folder(options) / fmt::format("sources-{}-of-{}-{}", options.shard, options.shards, ::getpid());
    claims_.emplace(state_folder(options) / "claims");
    write_file_atomically(sources_, list, {});
  }
  ~BatchRun() {
    std::error_code ignored;
    running_.end();
    fs::remove(sources_, ignored);
  }
  BatchRun(const BatchRun&) = delete;
  BatchRun& operator=(const BatchRun&) = delete;

  std::vector<BatchResult> run() {
    std::size_t next = 0;
    while (over_ < scenes_.size()) {
      while (next < scenes_.size() && running_.size() < static_cast<std::size_t>(options_.jobs)) {
        const std::size_t k = next++;
        // An error of the report ends the batch and is not a failure of the scene.
        if (!begin(k)) finish(k);
      }
      if (running_.size() == 0) continue;
      int status = 0;
      const auto job = running_.wait(status);
      if (!job) {
        report(0);
        continue;
      }
      take_result(*job, status);
      finish(job->scene);
    }
    return std::move(results_);
  }

 private:
  fs::path state_file(const BatchResult& result, const char* ending) const {
    return state_folder(options_) / (result.name + ending);
  }

  // Earlier versions kept no mark of scenes that were killed or failed.
  void keep_results_of_earlier_versions() const {
    if (fs::exists(state_version_file(options_))) return;
    for (const auto& entry : fs::directory_iterator(state_folder(options_))) {
      if (entry.path().extension() != ".log") continue;
      const std::string name = entry.path().stem().string();
      if (fs::exists(options_.out / name) && !fs::exists(state_folder(options_) / (name + ".done")))
        write_file_atomically(state_folder(options_) / (name + ".unfinished"), unknown_outputs, {});
    }
    write_file_atomically(state_version_file(options_), "", {});
  }

  // Starts a scene. Returns false if it needs no run or cannot be started.
  bool begin(std::size_t k) {
    BatchResult& result = results_[k];
    result.scene = scenes_[k];
    result.name = scene_title(scenes_[k]);
    const fs::path mark = state_file(result, ".done");
    try {
      auto lock = std::make_unique<FileLock>(state_file(result, ".lock"));
      if (!lock->held()) {
        result.message = "another batch is processing this scene into the same folder";
        return false;
      }
      const std::string key = key_of(options_, program_, script_, scenes_[k]);
      const BatchMark before = read_mark(mark, options_.out);
      const std::vector<BatchMark::File> outputs = known_outputs(options_, result.name);
      const std::string inputs = inputs_key(options_, scenes_[k]);
      if (options_.resume && is_up_to_date(before, key + inputs)) {
        result.status = BatchResult::Status::skipped;
        set_quality_message(result, before.below_requested_psnr);
        return false;
      }
      if (fs::exists(options_.out / result.name) && !written_by_batch(options_, result.name)) {
        result.message = fmt::format(
            "{} exists, but no run of the batch is known to have written it; check it, then move it elsewhere or "
            "remove it",
            (options_.out / result.name).string());
        return false;
      }
      if (const std::string edited = edited_output(outputs);
          !edited.empty() && fs::exists(state_file(result, ".done"))) {
        result.message = fmt::format(
            "{} was changed after the batch wrote it, and would be replaced; move it elsewhere, or remove it", edited);
        return false;
      }
      if (const std::string edited = edited_output(outputs); !edited.empty()) {
        // A run that was killed may have replaced it before it could say so.
        result.message = fmt::format(
            "{} is not as the last run that ended well wrote it; check it, then move it elsewhere or remove it",
            edited);
        return false;
      }
      for (const BatchMark::File& output : outputs) claims_->release(output.path, result.name);
      // Present until the process has ended well. Together with `.files` it lists the outputs of a run that did not.
      const fs::path unfinished = state_file(result, ".unfinished");
      fs::remove(unfinished);
      write_file_atomically(unfinished, with_relative_outputs(list_of(outputs), options_.out), {});
      fs::remove(mark);
      // Remove these names first: if they are links, their targets must not be overwritten.
      for (const char* ending : {".log", ".files"}) fs::remove(state_file(result, ending));
      running_.add(start(options_, scenes_[k], state_file(result, ".log"), state_file(result, ".files"), sources_,
                         hash_text(script_)),
                   {k, key, inputs, Clock::now(), std::move(lock)});
      return true;
    } catch (const FileError& why) {
      result.message = why.what();
      return false;
    }
  }

  void take_result(const Processes::Job& job, int status) {
    BatchResult& result = results_[job.scene];
    result.seconds = std::chrono::duration<double>(Clock::now() - job.since).count();
    // Exit code 4: done, but an export missed the PSNR that the script requires.
    std::error_code error;
    const fs::path unfinished = state_file(result, ".unfinished");
    const bool below = WIFEXITED(status) && WEXITSTATUS(status) == 4;
    if (!below && !(WIFEXITED(status) && WEXITSTATUS(status) == 0)) {
      result.message = last_error(state_file(result, ".log"), status);
      return;
    }
    if (key_of(options_, program_, script_, scenes_[job.scene]) != job.key) {
      result.message = "the scene changed while it was read; run the batch again";
      return;
    }
    set_quality_message(result, below);
    const std::string files = read_file(state_file(result, ".files"));
    result.status = BatchResult::Status::done;
    for (const BatchMark::File& output : mark_from(files, options_.out).wrote)
      if (const std::string other = claims_->claim(output.path, result.name); !other.empty()) {
        result.status = BatchResult::Status::failed;
        result.message = fmt::format("{} is also written for {}; put {{name}} into the output path in the script",
                                     output.path, other);
      }
    if (result.status == BatchResult::Status::done) {
      write_file_atomically(state_file(result, ".done"),
                            json{{"key", job.key + job.inputs}, {"below_asked", below}}.dump() + '\n' +
                                with_relative_outputs(files, options_.out),
                            {});
      fs::remove(unfinished, error);
    }
  }

  // Also throws Cancelled on cancellation.
  void report(std::size_t more) {
    over_ += more;
    progress_.at(fmt::format("{} of {} scenes", over_, scenes_.size()),
                 static_cast<double>(over_) / static_cast<double>(scenes_.size()));
  }
  void finish(std::size_t k) {
    ended_(results_[k]);
    report(1);
  }

  const BatchOptions& options_;
  const Progress& progress_;
  const std::function<void(const BatchResult&)>& ended_;
  std::uint64_t program_, script_;  // hashes of the files
  std::vector<fs::path> scenes_;
  std::vector<BatchResult> results_;
  fs::path sources_;  // list of protected paths
  std::optional<BatchClaims> claims_;
  std::size_t over_ = 0;
  Processes running_;  // ended first
};

}  // namespace

std::vector<BatchResult> run_batch(const BatchOptions& options, const Progress& progress,
                                   const std::function<void(const BatchResult&)>& ended) {
  return BatchRun(options, progress, ended).run();
}

}  // namespace rebake
