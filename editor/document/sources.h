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

/// New locations of moved sources: old path → new path of a source or of a folder that contains sources. An old path
/// may have several new ones, for sources with different contents.
using SourceLinks = std::multimap<std::filesystem::path, std::filesystem::path>;

/// Present location of a source with this content hash. Candidates are the new paths of the longest matching old path,
/// then the source's own path. The first with that content is taken, else the first candidate.
std::filesystem::path resolved_source(const std::filesystem::path& source, const std::string& content,
                                      const SourceLinks& links);
/// Throws FieldError, which lists the sources, for a link whose old path is neither a source nor contains one.
void check_links(const SourceLinks& links, const std::vector<std::filesystem::path>& sources);

/// The external input of an edit; nothing for edits that read no source.
std::optional<EditSource> source_of(const Edit& edit);
/// Files that an edit reads besides its source, from its JSON; its nodes need not exist. Throws Error.
std::vector<std::filesystem::path> input_files_of(nlohmann::json edit);
/// The field of an edit's JSON that contains the path of its source; null if it has none.
nlohmann::json* source_field(nlohmann::json& edit);

/// Thrown if sources of a project are missing or changed; lists all of them.
class SourcesUnavailable : public FileError {
 public:
  struct Source {
    std::filesystem::path path;  ///< path as imported
    std::string content;         ///< content hash as imported
    std::string trouble;         ///< reason, for users
  };
  SourcesUnavailable(const std::filesystem::path& file, const std::string& message, std::vector<Source> gone)
      : FileError(file, message), sources(std::move(gone)) {}
  std::vector<Source> sources;
};

/// Reason why a source with this content hash, relinked, is unusable (missing or changed), for users; empty if it is
/// unchanged.
std::string source_problem(const std::filesystem::path& source, const std::string& content, const SourceLinks& links);

/// The edit with the absolute path and the present content hash of its source, as replay needs them. Throws FileError,
/// and FieldError for an import without a path.
Edit completed(const Edit& edit);

/// Protects the sources of edits.
void add_sources(SourceGuard& guard, const std::vector<Edit>& edits);
/// Protects the folders that a scene's objects were read from.
void add_sources(SourceGuard& guard, const Scene& scene);

}  // namespace rebake
