#include "editor/batch/batch.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "editor/batch/batch_claims.h"
#include "editor/batch/batch_mark.h"
#include "editor/batch/batch_processes.h"
#include "editor/batch/batch_scenes.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

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
  for (const ScriptInput& input : script_inputs(read_file(options.script), script_variables(options, scene)))
    all += input.path.string() + '\n';
  return '-' + hash_text(content_hash(all));
}

void set_quality_message(BatchResult& result, bool below_requested_psnr) {
  result.below_requested_psnr = below_requested_psnr;
  if (below_requested_psnr) result.message = "an export is below the requested psnr; the log names the worst object";
}

}  // namespace

const char* to_string(BatchResult::Status status) {
  static const char* const names[] = {"done", "skipped", "failed"};
  return names[static_cast<int>(status)];
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
    begin_state_folder(options);
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
      running_.add(
          start_process(options_, scenes_[k], {state_file(result, ".log"), state_file(result, ".files"), sources_},
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
