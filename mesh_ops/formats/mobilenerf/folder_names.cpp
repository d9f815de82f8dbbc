#include "mesh_ops/formats/mobilenerf/folder_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

std::string lower_case(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

}  // namespace

FolderNames::FolderNames(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::string name = at->path().filename().string();
    spellings_[lower_case(name)].insert(std::move(name));
  }
  if (error) throw FileError(folder, "cannot be listed: " + error.message());
}

std::string FolderNames::spelt(const std::string& name) const {
  const auto found = spellings_.find(lower_case(name));
  if (found == spellings_.end()) return "";
  if (found->second.contains(name)) return name;
  if (found->second.size() > 1)
    throw FileError(folder_ / name, fmt::format("does not exist, but {} and {} do; remove one of them",
                                                *found->second.begin(), *std::next(found->second.begin())));
  return *found->second.begin();
}

}  // namespace rebake
