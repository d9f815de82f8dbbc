#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace rebake {

/// Files that Rebake made carry its name and a hash of their other bytes, so that those which someone changed
/// afterwards are known as theirs.

/// The attribute of an OpenEXR file that write_mark() completes: name, text.
extern const std::pair<std::string, std::string> openexr_mark;

/// Adds the mark to the bytes of a PNG, JPEG or WebP file, and completes that of an OpenEXR file. `width`, `height`,
/// `has_alpha`: of the picture.
std::string with_mark(const std::string& bytes, int width, int height, bool has_alpha);

/// Whether a PNG, JPEG, WebP or OpenEXR file carries the mark, and is as it was written. False for files that cannot be
/// read.
bool has_mark(const std::filesystem::path& file);

}  // namespace rebake
