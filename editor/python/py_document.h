#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "editor/actions/session.h"
#include "editor/edits/nodes/import.h"
#include "editor/python/work.h"

namespace rebake {

namespace py = pybind11;

class PyDocument;

/// Sources of all documents of the process: no output of one may replace a source of another. A folder that the process
/// exported may be replaced while other documents only import it: notebooks open their exports and export again.
/// Thread-safe.
class LiveDocuments {
 public:
  struct Entry {
    SourceGuard sources;
    std::vector<std::filesystem::path> imports;  ///< canonical
    bool holds_work = false;                     ///< edits, a journal or a project depend on the sources
  };
  void publish(const PyDocument* document, Entry entry, const std::vector<std::string>& exports) {
    const std::scoped_lock lock(mutex_);
    entries_[document] = std::move(entry);
    std::error_code error;
    for (const std::string& folder : exports) exports_.insert(std::filesystem::weakly_canonical(folder, error));
  }
  void forget(const PyDocument* document) {
    const std::scoped_lock lock(mutex_);
    entries_.erase(document);
  }
  std::vector<SourceGuard> sources_of_others(const PyDocument* document) {
    const std::scoped_lock lock(mutex_);
    std::vector<SourceGuard> others;
    for (const auto& [other, entry] : entries_) {
      const bool made_here = !entry.imports.empty() &&
                             std::all_of(entry.imports.begin(), entry.imports.end(),
                                         [&](const std::filesystem::path& path) { return exports_.contains(path); });
      if (other != document && (entry.holds_work || !made_here)) others.push_back(entry.sources);
    }
    return others;
  }

 private:
  std::mutex mutex_;
  std::map<const PyDocument*, Entry> entries_;
  std::set<std::filesystem::path> exports_;  ///< canonical
};
LiveDocuments& live_documents();

/// A session that Python may use from any thread. All access releases the GIL before it locks the mutex. Readers copy
/// the scene, which is cheap.
class PyDocument {
 public:
  PyDocument() { publish_sources(); }
  explicit PyDocument(Document document) {
    session_.document = std::move(document);
    publish_sources();
  }
  ~PyDocument() { live_documents().forget(this); }
  PyDocument(const PyDocument&) = delete;
  PyDocument& operator=(const PyDocument&) = delete;

  py::object progress = py::none();  ///< progress callback, or None

  /// Runs `job` with run_without_gil(). If the callback uses this document, it waits until the job is done.
  void work(const std::function<void(Session&)>& job) {
    run_without_gil(progress, [&](const Progress& on_the_way) {
      const std::scoped_lock lock(mutex_);
      session_.progress = on_the_way;
      session_.document.protect_sources_of_others(live_documents().sources_of_others(this));
      try {
        job(session_);
      } catch (...) {
        session_.progress = {};
        publish_sources();
        throw;
      }
      session_.progress = {};
      publish_sources();
    });
  }

  Scene scene() {
    const ModuleGuard inside;
    const py::gil_scoped_release others;
    const std::scoped_lock lock(mutex_);
    return session_.scene();
  }
  SourceGuard sources() {
    const ModuleGuard inside;
    const py::gil_scoped_release others;
    const std::scoped_lock lock(mutex_);
    return session_.document.sources();
  }
  std::vector<Edit> edits() {
    const ModuleGuard inside;
    const py::gil_scoped_release others;
    const std::scoped_lock lock(mutex_);
    return session_.document.history().edits();
  }

 private:
  void publish_sources() {
    const Document& document = session_.document;
    LiveDocuments::Entry entry{
        document.own_sources(), {}, document.has_saved_work() || document.history().redo_count() > 0};
    std::error_code error;
    for (const Edit& edit : document.history().edits()) {
      if (const Import* import = edit.as<Import>())
        entry.imports.push_back(std::filesystem::weakly_canonical(scene_root(import->path), error));
      else
        entry.holds_work = true;
    }
    std::vector<std::string> written = session_.exports;
    written.insert(written.end(), session_.outputs.begin(), session_.outputs.end());
    live_documents().publish(this, std::move(entry), written);
  }

  std::mutex mutex_;
  Session session_;
};

/// Adds the methods of class Document that edit, save, export and render, and a method per edit.
void add_document_methods(py::class_<PyDocument>& type);
/// Adds the methods of class Document that give its arrays, and select_mask().
void add_array_methods(py::class_<PyDocument>& type);
/// Adds open() and recover().
void add_openers(py::module_& module);
/// Adds move_by_cage() and wrap().
void add_geometry(py::module_& module);

/// The selections of all objects as masks, by name.
py::dict selections_of(PyDocument& document);

}  // namespace rebake
