#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace rebake {

/// The attribute of an OpenEXR file that with_mark() completes: name, text.
extern const std::pair<std::string, std::string> openexr_mark;

/// Adds the mark to the bytes of a PNG, JPEG, WebP or SVG file, and completes it in an OpenEXR file. The mark names
/// Rebake, and holds a hash of all other bytes, so that it becomes wrong if someone changes the picture. `width`,
/// `height`, `has_alpha`: of a WebP.
std::string with_mark(const std::string& bytes, int width, int height, bool has_alpha);
/// The same for a PNG or SVG.
std::string with_mark(const std::string& png_or_svg);

/// Whether a PNG, JPEG, WebP, SVG or OpenEXR file carries the mark, and is as it was written. False for files that
/// cannot be read.
bool has_mark(const std::filesystem::path& file);

}  // namespace rebake
