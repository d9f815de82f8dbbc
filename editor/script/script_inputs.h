#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

class Document;

/// A file or scene folder that a script reads.
struct ScriptInput {
  std::filesystem::path path;
  bool content_known;           ///< its line has the field `content`, a hash of the expected content
  bool written_before = false;  ///< an earlier line writes it: its field `out` has this path
};

/// All inputs of a script (imports, environment maps, cage meshes, cameras, photographs, masks) in the order of its
/// lines, with variables replaced. Invalid lines are skipped.
std::vector<ScriptInput> script_inputs(std::string_view script, const std::map<std::string, std::string>& variables);

/// Protects existing inputs from outputs of earlier lines: files, and the files in scene folders. A scene folder may be
/// replaced as a whole before it is imported, because a script may import its own export and may run again. It may not
/// if the import expects a content hash, nor may such a file.
void protect_input_files(Document& document, std::string_view script,
                         const std::map<std::string, std::string>& variables);

}  // namespace rebake
