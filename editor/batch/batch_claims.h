#pragma once

#include <filesystem>
#include <string>

namespace rebake {

/// Ownership of outputs by scenes, across all shards of a batch: one file per output that is created exclusively
/// (O_EXCL) and has the scene's name.
class BatchClaims {
 public:
  /// Creates the folder of the files if needed.
  explicit BatchClaims(std::filesystem::path folder);

  /// Claims an output for a scene. Returns the name of the scene that owns it already; empty if the claim succeeds.
  /// Throws FileError.
  std::string claim(const std::string& output, const std::string& scene) const;
  /// Ends a scene's claim; that of another scene stays.
  void release(const std::string& output, const std::string& scene) const;

 private:
  std::filesystem::path path_of(const std::string& output) const;

  std::filesystem::path folder_;
};

}  // namespace rebake
