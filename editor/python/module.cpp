// The Python module: class Document, and functions.
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>

#include "editor/document/result_store.h"
#include "editor/python/py_document.h"
#include "editor/python/stub.h"
#include "mesh_ops/base/error.h"

namespace rebake {

PYBIND11_MODULE(rebake, module) {
  py::module_::import("numpy");  // here, because two threads must not import it first at the same time
  set_result_cache(ResultStore::user_store());
  module.doc() = "Edit and compose baked NeRF scenes (MobileNeRF format).";
  const auto& error = py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
  py::register_exception<FileError>(module, "FileError", error);
  py::register_exception<FieldError>(module, "FieldError", error);
  py::register_exception<EditError>(module, "EditError", error);
  py::register_exception<DeviceError>(module, "DeviceError", error);

  py::class_<PyDocument> type(module, "Document", "A scene with its history. An edit that raises changes nothing.");
  type.def(py::init<>());
  add_document_methods(type);
  add_array_methods(type);
  add_openers(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(&shut_down_workers));
  add_geometry(module);
  module.def("python_stub", &python_stub, "The module's type stub.");
}

}  // namespace rebake
