#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/edits/edit.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// Where sources lie now that were moved: old path → new path; folders stand for all in them. An old path may have
/// several new ones, for sources that were read from it with different contents.
using Relinked = std::multimap<std::filesystem::path, std::filesystem::path>;

/// Where a source with this content lies: of the new paths of the longest old path that holds it, and then of its own
/// path, the first with that content; else the first new path.
std::filesystem::path relinked(const std::filesystem::path& source, const std::string& content, const Relinked& links);
/// Throws FieldError, naming the sources there are, for a link whose old path none of them lies at or in.
void check_links(const Relinked& links, const std::vector<std::filesystem::path>& sources);

/// What an edit reads: a folder that is imported, or the picture of a light that is on.
struct EditSource {
  std::filesystem::path path;
  std::string content;  ///< hash of what is there
};
std::optional<EditSource> source_of(const Edit& edit);
/// Hash of what lies there now: a file, or a folder's scene. Throws FileError.
std::uint64_t content_at(const std::filesystem::path& path);
/// Where an edit's JSON says it; null for an edit that reads nothing.
nlohmann::json* source_field(nlohmann::json& edit);

/// Sources that are not as they were: moved, removed or changed.
class SourcesGone : public FileError {
 public:
  struct Source {
    std::filesystem::path path;  ///< as it was imported
    std::string content;         ///< hash of it, as it was
    std::string trouble;         ///< what is wrong with it
  };
  SourcesGone(const std::filesystem::path& file, const std::string& message, std::vector<Source> gone)
      : FileError(file, message), sources(std::move(gone)) {}
  std::vector<Source> sources;
};

/// What is wrong with a source of this content where the links say it lies; empty when it is as it was.
std::string trouble_with(const std::filesystem::path& source, const std::string& content, const Relinked& links);

/// The edit with everything it needs to be repeated later: its source's absolute path and the hash of what lies there
/// now. Throws FileError.
Edit completed(const Edit& edit);

/// Adds what edits read.
void add_sources(SourceGuard& guard, const std::vector<Edit>& edits);
/// Adds the folders that a scene's objects were read from.
void add_sources(SourceGuard& guard, const Scene& scene);

}  // namespace rebake
