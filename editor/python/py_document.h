#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "editor/actions/session.h"
#include "editor/python/work.h"

namespace rebake {

namespace py = pybind11;

class PyDocument;

/// Sources of all documents of the process: no output of one document may replace a source of another. There is one
/// exception, because notebooks open their exports and export again: a document may replace a scene that another
/// document has only imported, if this process exported it and it was unchanged when it was imported. Thread-safe.
class LiveDocuments {
 public:
  void publish(const PyDocument* document, SourceGuard sources) {
    const std::scoped_lock lock(mutex_);
    sources_[document] = std::move(sources);
  }
  /// Remembers that this process has just written something, if it is a scene.
  void add_export(const std::filesystem::path& path) {
    const std::optional<std::uint64_t> content = content_at(path);
    const std::scoped_lock lock(mutex_);
    if (content) exports_[plain_path(path)] = *content;
  }
  /// Whether a path has what this process exported there.
  bool has_export(const std::filesystem::path& path) {
    std::unique_lock lock(mutex_);
    const auto found = exports_.find(plain_path(path));
    if (found == exports_.end()) return false;
    const std::uint64_t exported = found->second;
    lock.unlock();  // reading takes long
    return content_at(path) == exported;
  }
  void forget(const PyDocument* document) {
    const std::scoped_lock lock(mutex_);
    sources_.erase(document);
  }
  std::vector<SourceGuard> sources_of_others(const PyDocument* document) {
    const std::scoped_lock lock(mutex_);
    std::vector<SourceGuard> others;
    for (const auto& [other, sources] : sources_)
      if (other != document) others.push_back(sources);
    return others;
  }

 private:
  // Of a scene; null if there is none.
  static std::optional<std::uint64_t> content_at(const std::filesystem::path& path);

  std::mutex mutex_;
  std::map<const PyDocument*, SourceGuard> sources_;
  std::map<std::filesystem::path, std::uint64_t> exports_;  ///< canonical paths, and the content
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
  struct Imported {
    std::string path;             ///< as in the edit
    std::filesystem::path place;  ///< absolute when it was imported: the working directory may change
    bool made_here;               ///< it had what this process exported there
  };
  void publish_sources();

  std::mutex mutex_;
  Session session_;
  std::vector<Imported> imports_;          ///< of the history
  std::size_t exports_ = 0, outputs_ = 0;  ///< numbers of those that were published
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
