#pragma once

#include <filesystem>
#include <vector>

#include "editor/edits/table.h"

namespace rebake {

/// A project: which sources were imported and what was done with them, as edits (named views among them). Sources are
/// named relative to the project's file and by the hash of their content, so that a moved or changed one is found out.
///
///     {"rebake_project": 1,
///      "sources": [{"path": "scenes/ficus", "content": "<16 hexadecimal digits>"}],
///      "edits": [{"op": "import", "path": "scenes/ficus", …}, …],
///      "joined": [3]}                 numbers, from 1, of edits that were made together with the one before

/// True for a regular file whose name ends in .rebake.
bool is_project_file(const std::filesystem::path& path);

/// Writes the project whole or not at all. Imports must be completed(). Throws FileError.
void write_project(const std::filesystem::path& path, const std::vector<Edit>& edits, const std::vector<bool>& joined);

/// The scenes after each edit of a project. Throws FileError for a file that is no project, is from a newer version, or
/// whose sources moved or changed: all of them are named.
struct ReadProject {
  std::vector<Edit> edits;
  std::vector<Scene> scenes;  ///< one after each edit
  std::vector<bool> joined;   ///< each made together with the one before
};
ReadProject read_project(const std::filesystem::path& path);

/// The edit with everything it needs to be repeated later: an import gets its absolute path and the hash of what lies
/// there now. Throws FileError.
Edit completed(const Edit& edit);

}  // namespace rebake
