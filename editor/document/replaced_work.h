#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Whether a file is a project, even a damaged one or one of a newer version.
bool holds_project(const std::filesystem::path& path);

/// For outputs that are no projects: throws FileError if the file is a journal or a project, whose edits would be lost,
/// a file of a scene folder, a photograph or mask of a capture, or has the name of a picture of the film in its folder.
void refuse_replacing_work(const std::filesystem::path& path);

/// For every project that is written: throws FileError if the file exists and is no project, or one of a newer version.
void refuse_replacing_foreign(const std::filesystem::path& path);

/// The edits of a project as JSON text, in order; empty if the file is no readable project.
std::vector<std::string> edits_in(const std::filesystem::path& project);

/// For pictures whose names were not asked for: throws FileError if a capture names the file, also if Rebake rendered
/// it.
void refuse_replacing_captured(const std::filesystem::path& path);

/// For projects that are written by name: throws FileError if the file exists and is another file than a project, a
/// damaged project, one of a newer version, or one with more than `edits` edits.
void refuse_replacing_more(const std::filesystem::path& path, std::size_t edits);

}  // namespace rebake
