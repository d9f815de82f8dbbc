#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

}  // namespace rebake
