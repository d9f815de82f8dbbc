#include "editor/python/py_document.h"

#include <algorithm>

#include "editor/edits/nodes/import.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

LiveDocuments& live_documents() {
  // Never destroyed: documents may outlive the module's statics at exit.
  static auto* const documents = new LiveDocuments;
  return *documents;
}

std::optional<std::uint64_t> LiveDocuments::content_at(const std::filesystem::path& path) {
  try {
    if (format_at(path) == nullptr) return std::nullopt;
    return output_hash_at(path);
  } catch (const std::exception&) {
    return std::nullopt;  // it was removed or damaged since the export
  }
}

void PyDocument::publish_sources() {
  while (exports_ < session_.exports.size()) live_documents().add_export(session_.exports[exports_++]);
  while (outputs_ < session_.outputs.size()) live_documents().add_export(session_.outputs[outputs_++]);
  const Document& document = session_.document;
  std::vector<std::string> paths;
  for (const Edit& edit : document.history().edits())
    if (const Import* import = edit.as<Import>()) paths.push_back(import->path);
  std::size_t known = 0;
  while (known < std::min(imports_.size(), paths.size()) && imports_[known].path == paths[known]) ++known;
  imports_.resize(known);
  for (; known < paths.size(); ++known) {
    const std::filesystem::path place = absolute_path(scene_root(paths[known]));
    imports_.push_back({paths[known], place, live_documents().has_export(place)});
  }
  // Edits, a journal or a project depend on the sources.
  const bool holds_work = paths.size() < document.history().edits().size() || document.has_saved_work() ||
                          document.history().redo_count() > 0;
  SourceGuard sources = document.own_sources();
  if (!holds_work)
    for (const Imported& one : imports_)
      if (one.made_here) sources.release(one.place);
  live_documents().publish(this, std::move(sources));
}

}  // namespace rebake
