#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace rebake {

/// Detects that another program writes to the path of an output during long work.
class OutputState {
 public:
  /// Reads the files there. Throws FileError.
  explicit OutputState(std::filesystem::path path);
  /// Whether there was a file, or a folder that was not empty.
  bool had_content() const { return content_.has_value(); }
  /// Whether there is something now. Throws FileError.
  bool has_content() const;
  /// Whether there is other content now, which would be lost. Throws FileError.
  bool has_other_content() const;

 private:
  std::filesystem::path path_;
  std::optional<std::uint64_t> content_;  ///< output_hash_at(); 0: a folder that is no scene; null: nothing there
};

}  // namespace rebake
