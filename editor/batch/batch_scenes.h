#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "editor/batch/batch_mark.h"
#include "editor/batch/batch_options.h"

namespace rebake {

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

/// The script's variables for a scene.
std::map<std::string, std::string> script_variables(const BatchOptions& options, const std::filesystem::path& scene);

/// Folder of the batch's own files: per scene a mark when it is done (`.done`), the outputs of a run that did not end
/// well (`.unfinished` and `.files`), and the log of its process (`.log`).
std::filesystem::path state_folder(const BatchOptions& options);

/// Marks a new state folder, or one of an earlier version, which kept no mark of scenes that were killed or failed.
/// Throws FileError.
void begin_state_folder(const BatchOptions& options);

/// The outputs of a scene that are known: of its last run that ended well, and of a run after it that did not.
std::vector<BatchMark::File> known_outputs(const BatchOptions& options, const std::string& name);

/// Whether a batch wrote the result of this name: it, or something in it, is listed as written; or the batch was one of
/// an earlier version, which kept no lists. The folder may have been moved since.
bool written_by_batch(const BatchOptions& options, const std::string& name);

}  // namespace rebake
