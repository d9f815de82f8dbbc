#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// A scene folder or file that a script reads.
struct ScriptInput {
  std::filesystem::path path;
  bool content_known;  ///< its line says which content it expects
};

/// All inputs of a script (imports, pictures of light, cage meshes), with variables filled in, in the order of its
/// lines. Lines that run_script() would refuse are left out.
std::vector<ScriptInput> script_inputs(std::string_view text, const std::map<std::string, std::string>& variables);

}  // namespace rebake
