// Functions that open a scene, a project or a journal as a Document.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <optional>

#include "editor/document/project.h"
#include "editor/edits/nodes/import.h"
#include "editor/fields/codec.h"
#include "editor/python/json_python.h"
#include "editor/python/py_document.h"
#include "editor/python/warnings.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/files.h"

using nlohmann::json;

namespace rebake {

namespace {

SourceLinks links_from(const py::dict& sources) {
  SourceLinks links;
  const auto path_from = [](const py::handle& value) {
    try {
      return value.cast<std::filesystem::path>();
    } catch (const py::cast_error&) {
      throw FieldError("sources", "must map paths to paths, or to lists of paths");
    }
  };
  for (const auto& [from, to] : sources) {
    const std::filesystem::path old = path_from(from);
    if (py::isinstance<py::list>(to) || py::isinstance<py::tuple>(to))
      for (const auto& one : to) links.emplace(old, path_from(one));
    else
      links.emplace(old, path_from(to));
  }
  return links;
}

std::unique_ptr<PyDocument> open_document(const std::filesystem::path& path, const std::string& axes,
                                          const py::object& callback, const py::dict& sources) {
  const SourceLinks links = links_from(sources);
  if (!links.empty() && !is_project_file(path)) throw FieldError("sources", "can be given for projects only");
  std::optional<Document> opened;
  std::vector<std::string> messages;
  Import import;
  import.path = path.string();
  import.axes = Codec<Axes>::read(json(axes), {});
  run_without_gil(callback, [&](const Progress& progress) {
    if (is_project_file(path)) {
      opened = Document::open(path, links, progress);
      return;
    }
    opened.emplace();
    for (const Report& report : opened->edits({import}, progress)) messages = report.lines;
  });
  warn_of_notes(messages);
  auto document = std::make_unique<PyDocument>(std::move(*opened));
  document->progress = callback;
  return document;
}

std::unique_ptr<PyDocument> recover_document(const std::filesystem::path& journal, const py::dict& sources,
                                             const py::object& callback) {
  const SourceLinks links = links_from(sources);
  std::optional<Document::Recovered> recovered;
  run_without_gil(callback, [&](const Progress& progress) { recovered = Document::recover(journal, links, progress); });
  if (!recovered->document.keeps_journal())
    warn(journal.string() +
         " is not changed, and further edits are not in a journal: call keep_journal with another file, or save");
  if (recovered->torn)
    recovered->lost.insert(recovered->lost.begin(), "the last edit, whose line in the journal is incomplete");
  if (recovered->skipped_undone > 0)
    recovered->lost.push_back(counted(recovered->skipped_undone, "undone edit") +
                              ", because a source is missing or has changed");
  for (const std::string& lost : recovered->lost) warn("not recovered: " + lost);
  auto document = std::make_unique<PyDocument>(std::move(recovered->document));
  document->progress = callback;
  return document;
}

}  // namespace

void add_openers(py::module_& module) {
  module.def(
      "open", &open_document, py::arg("path"), py::arg("axes") = "360", py::arg("progress") = py::none(),
      py::arg("sources") = py::dict(),
      "Opens a MobileNeRF folder, a Rebake scene or a project. `sources` maps moved folders of a project to their "
      "new paths.");
  module.def(
      "recover", &recover_document, py::arg("journal"), py::arg("sources") = py::dict(),
      py::arg("progress") = py::none(),
      "Recovers a document from a journal. `sources` maps moved folders to their new paths. Warns about edits that "
      "are lost.");
}

}  // namespace rebake
