#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "editor/document/history.h"
#include "editor/document/sources.h"
#include "editor/edits/edit.h"

namespace rebake {

/// A project file lists imported sources and all edits (stored views are edits too). Each source has a path relative to
/// the file's real folder and a content hash, which detects moved and changed sources. The checksum detects damage;
/// remove it to edit the file by hand.
///
///     {"rebake_project": 3,
///      "sources": [{"path": "scenes/ficus", "content": "<16 hexadecimal digits>"}],
///      "edits": [{"op": "import", "path": "scenes/ficus", …}, …],
///      "joined": [3],                 edits, from 1, that belong to the same step as the one before
///      "replaces": [[5, 1], …],       edit 5 replaces 1 edit before it: it was applied to the scene after edit 3
///      "checksum": "<digits: XXH64 of all else, as JSON without whitespace>"}
///
/// Version 1 had no checksum, version 2 no "replaces"; both are still read. Projects without "replaces" are written as
/// version 2.

/// The newest version of project files, which this program reads.
inline constexpr int project_version = 3;

/// True for a regular file whose name ends in .rebake.
bool is_project_file(const std::filesystem::path& path);

/// What writing a project found.
struct SavedProject {
  std::vector<std::string> warnings;
  bool opens = true;  ///< false if a source is missing or has changed, so that the project cannot be opened
};

/// Writes the project atomically and syncs it. Imports must be completed(). Warns of each missing or changed source.
/// Throws FileError, also if `guard` protects the path.
SavedProject write_project(const std::filesystem::path& path, const std::vector<History::Entry>& entries,
                           const SourceGuard& guard, const Progress& progress = {});

/// The absolute paths of a project's sources and of all files that its edits read; empty if the file is no readable
/// project.
std::vector<std::filesystem::path> project_sources(const std::filesystem::path& path);

/// Receives each edit of a project while it is read, and the scene after it.
using EditVisitor = std::function<void(const History::Entry& entry, const Scene& after)>;
/// Replays a project edit by edit. Memory holds only the last scene and those that a later edit starts from. Throws
/// FileError for a file that is no project, is damaged or has a newer version; SourcesUnavailable, naming all missing
/// and changed sources; Cancelled.
void read_project(const std::filesystem::path& path, const EditVisitor& each, const SourceLinks& links = {},
                  const Progress& progress = {});

}  // namespace rebake
