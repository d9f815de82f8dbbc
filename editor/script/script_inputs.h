#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// A file or scene folder that a script reads.
struct ScriptInput {
  std::filesystem::path path;
  bool content_known;           ///< its line has the field `content`, a hash of the expected content
  bool written_before = false;  ///< an earlier line writes it: its field `out` has this path
};

/// All inputs of a script (imports, environment maps, cage meshes, cameras, photographs, masks) in the order of its
/// lines, with variables replaced. Invalid lines are skipped.
std::vector<ScriptInput> script_inputs(std::string_view script, const std::map<std::string, std::string>& variables);

}  // namespace rebake
