#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "editor/document/history.h"
#include "editor/document/sources.h"
#include "editor/edits/edit.h"

namespace rebake {

/// A project: which sources were imported and what was done with them, as edits (named views among them). Sources are
/// named relative to the folder that the project's file really lies in, and by the hash of their content, so that a
/// moved or changed one is found out. The checksum tells damage; who changes the file by hand takes it out.
///
///     {"rebake_project": 3,
///      "sources": [{"path": "scenes/ficus", "content": "<16 hexadecimal digits>"}],
///      "edits": [{"op": "import", "path": "scenes/ficus", …}, …],
///      "joined": [3],                 numbers, from 1, of edits that were made together with the one before
///      "replaces": [[5, 1], …],       edit 5 replaces 1 edit before it: it was applied to the scene after edit 3
///      "checksum": "<digits: XXH64 of all else, as JSON without blanks>"}
///
/// Version 1 had no checksum, version 2 no "replaces"; both are still read. Projects without "replaces" are written as
/// version 2.

/// True for a regular file whose name ends in .rebake.
bool is_project_file(const std::filesystem::path& path);

/// Writes the project whole or not at all, on the disk when this returns. Imports must be completed(). Throws
/// FileError, also where the file would lie in one of `guard`'s sources. Returns a warning for each source that is not
/// as it was: without it the project cannot be opened.
std::vector<std::string> write_project(const std::filesystem::path& path, const std::vector<History::Entry>& entries,
                                       const SourceGuard& guard, const Progress& progress = {});

/// An edit of a project that is read, and the scene after it.
using EachEdit = std::function<void(const History::Entry& entry, const Scene& after)>;
/// Carries a project out, one edit after the other. Holds the last scene, and scenes that a later edit starts from.
/// Throws FileError for a file that is no project, is damaged or from a newer version, SourcesGone where sources moved
/// or changed (all of them are named), Cancelled.
void read_project(const std::filesystem::path& path, const EachEdit& each, const Relinked& links = {},
                  const Progress& progress = {});

}  // namespace rebake
