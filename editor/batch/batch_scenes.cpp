#include "editor/batch/batch_scenes.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <set>

#include "editor/document/sources.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

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

}  // namespace

std::map<std::string, std::string> script_variables(const BatchOptions& options, const fs::path& scene) {
  std::map<std::string, std::string> variables;
  for (const std::string& variable : options.variables)
    variables[variable.substr(0, variable.find('='))] = variable.substr(variable.find('=') + 1);
  variables["name"] = scene_title(scene);
  variables["path"] = scene.string();
  return variables;
}

fs::path state_folder(const BatchOptions& options) { return options.out / ".rebake-batch"; }

void begin_state_folder(const BatchOptions& options) {
  if (fs::exists(state_version_file(options))) return;
  for (const auto& entry : fs::directory_iterator(state_folder(options))) {
    if (entry.path().extension() != ".log") continue;
    const std::string name = entry.path().stem().string();
    if (fs::exists(options.out / name) && !fs::exists(state_folder(options) / (name + ".done")))
      write_file_atomically(state_folder(options) / (name + ".unfinished"), unknown_outputs, {});
  }
  write_file_atomically(state_version_file(options), "", {});
}

std::vector<BatchMark::File> known_outputs(const BatchOptions& options, const std::string& name) {
  const fs::path state = state_folder(options);
  const BatchMark done = read_mark(state / (name + ".done"), options.out);
  if (fs::exists(state / (name + ".done"))) return done.wrote;
  return latest_outputs(read_mark(state / (name + ".unfinished"), options.out),
                        read_mark(state / (name + ".files"), options.out));
}

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
    return path.filename() == result.filename() && is_unchanged_output({result.string(), file.content, file.bytes});
  });
}

namespace {

// Refuses to replace scenes that no batch wrote, and what links refer to.
void check_results(const BatchOptions& options, const ScenesByName& scenes) {
  if (std::error_code error; fs::is_symlink(state_folder(options), error))
    throw FieldError("--out",
                     fmt::format("{} is a link; remove it, or choose another folder", state_folder(options).string()));
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

// See BatchScenes::protected_paths.
std::vector<std::pair<std::string, fs::path>> guarded_by(const BatchOptions& options, const ScenesByName& scenes) {
  const std::string script = read_file(options.script);
  std::vector<std::pair<std::string, fs::path>> protected_paths;
  std::map<fs::path, std::set<std::string>> readers;
  for (const auto& [name, folder] : scenes) {
    protected_paths.emplace_back("", fs::absolute(folder));
    for (const ScriptInput& input : script_inputs(script, script_variables(options, folder)))
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
    // Nor may a script write to it.
    result.protected_paths.emplace_back("", fs::absolute(options.report));
  }
  const auto shards = static_cast<std::uint64_t>(options.shards);
  for (const auto& [name, folder] : by_name)
    if (content_hash(name) % shards == static_cast<std::uint64_t>(options.shard - 1))
      result.shard_scenes.push_back(folder);
  return result;
}

}  // namespace rebake
