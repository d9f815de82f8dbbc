#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Record of a finished scene: the key of its inputs, and the files that its process read and wrote.
struct BatchMark {
  struct File {
    std::string path, content;  ///< content: hash, hexadecimal
  };
  std::string key;
  bool below_requested_psnr = false;  ///< an export missed the PSNR that the script requires
  std::vector<File> read, wrote;
};

/// Parses one JSON object per line; skips other lines.
BatchMark mark_from(const std::string& text);
/// The mark in a file; empty if the file does not exist.
BatchMark read_mark(const std::filesystem::path& path);
/// The text of a mark without its key, so that it only lists files.
std::string list_without_key(const std::string& mark);

/// Whether the file or folder exists with its recorded content.
bool is_unchanged(const BatchMark::File& file);
/// Whether the scene was done with this key, and all files that it read and wrote are unchanged.
bool is_up_to_date(const BatchMark& mark, const std::string& key);
/// The first output that exists with another content than it was written with; empty if there is none.
std::string edited_output(const BatchMark& mark);

}  // namespace rebake
