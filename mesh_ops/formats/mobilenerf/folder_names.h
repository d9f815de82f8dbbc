#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace rebake {

/// The files of a folder by name, whose case does not matter: tools on other systems write "Shape0.OBJ".
class FolderNames {
 public:
  /// Lists the folder. Throws FileError if it cannot be read.
  explicit FolderNames(const std::filesystem::path& folder);

  /// The name of a file as the folder spells it; empty if there is none. The exact spelling is preferred. Throws
  /// FileError if only several other spellings exist.
  std::string spelt(const std::string& name) const;
  bool has(const std::string& name) const { return !spelt(name).empty(); }

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::set<std::string>> spellings_;  ///< by name in lower case
};

}  // namespace rebake
