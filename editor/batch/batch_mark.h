#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Record of a finished scene: the key of its inputs, and the files that its process read and wrote.
struct BatchMark {
  struct File {
    std::string path, content;  ///< content: hash, hexadecimal
    bool bytes = false;         ///< an output: the hash is output_hash_at(); earlier versions: content_hash_at()
  };
  std::string key;
  bool below_requested_psnr = false;  ///< an export missed the PSNR that the script requires
  std::vector<File> read, wrote;
};

/// Parses one JSON object per line; skips other lines. Relative paths start at `out`.
BatchMark mark_from(const std::string& text, const std::filesystem::path& out);
/// The mark in a file; empty if the file does not exist.
BatchMark read_mark(const std::filesystem::path& path, const std::filesystem::path& out);
/// The text of a mark with relative paths for outputs in `out`, which may be moved.
std::string with_relative_outputs(const std::string& mark, const std::filesystem::path& out);
/// The outputs of a mark, with those that a later mark lists replaced.
std::vector<BatchMark::File> latest_outputs(const BatchMark& earlier, const BatchMark& later);
/// The text of a mark that only lists outputs.
std::string list_of(const std::vector<BatchMark::File>& outputs);

/// Whether a written file or folder exists with its recorded content.
bool is_unchanged_output(const BatchMark::File& file);
/// Whether the scene was done with this key, and all files that it read and wrote are unchanged.
bool is_up_to_date(const BatchMark& mark, const std::string& key);
/// The first output that exists with another content than it was written with; empty if there is none.
std::string edited_output(const std::vector<BatchMark::File>& outputs);

}  // namespace rebake
