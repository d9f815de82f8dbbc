#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <mutex>
#include <vector>

#include "editor/actions/session.h"
#include "editor/python/work.h"

namespace rebake {

namespace py = pybind11;

/// A session that Python may use from any thread. All access releases the GIL before it locks the mutex. Readers copy
/// the scene, which is cheap.
class PyDocument {
 public:
  PyDocument() = default;
  explicit PyDocument(Document document) { session_.document = std::move(document); }

  py::object progress = py::none();  ///< progress callback, or None
  std::filesystem::path project;     ///< project file that was opened or saved last; empty: none

  /// Runs `job` with run_without_gil(). If the callback uses this document, it waits until the job is done.
  void work(const std::function<void(Session&)>& job) {
    run_without_gil(progress, [&](const Progress& on_the_way) {
      const std::scoped_lock lock(mutex_);
      session_.progress = on_the_way;
      try {
        job(session_);
      } catch (...) {
        session_.progress = {};
        throw;
      }
      session_.progress = {};
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
