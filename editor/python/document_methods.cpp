// Methods of class Document: edits, history, files and pictures.
#include <pybind11/eval.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>
#include <utility>

#include "editor/actions/compare_photographs.h"
#include "editor/actions/export_action.h"
#include "editor/actions/film_action.h"
#include "editor/actions/forget_light_model.h"
#include "editor/actions/lit.h"
#include "editor/actions/publish_action.h"
#include "editor/actions/render_action.h"
#include "editor/actions/save.h"
#include "editor/actions/train_light.h"
#include "editor/actions/use_light_model.h"
#include "editor/actions/views.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/support.h"
#include "editor/fields/codec.h"
#include "editor/python/json_python.h"
#include "editor/python/py_document.h"
#include "editor/python/stub.h"
#include "editor/python/warnings.h"
#include "mesh_ops/base/files.h"
#include "render/picture.h"

using nlohmann::json;

namespace rebake {

namespace {

// Runs work and returns its messages.
template <class Work>
std::vector<std::string> messages_of(Session& session, const Work& work) {
  std::vector<std::string> lines;
  const auto say = std::exchange(session.say, [&lines](const std::string& text) { lines.push_back(text); });
  try {
    work();
  } catch (...) {
    session.say = say;
    throw;
  }
  session.say = say;
  return lines;
}
template <class ActionStruct>
std::vector<std::string> notes_of(Session& session, const ActionStruct& action) {
  return messages_of(session, [&] { run(session, action); });
}

Edit edit_once(PyDocument& document, const json& line) {
  std::optional<Edit> made;
  std::vector<std::string> messages;
  document.work([&](Session& session) {
    session.document.protect_files_of(line);
    check_boxes(line);
    made = read_edit(line, session.scene());
    messages = messages_of(session, [&] { session.edit(*made); });
  });
  warn_of_notes(messages);
  return *made;
}

py::array render_picture(PyDocument& document, int width, int height, int samples, const py::object& camera,
                         const std::string& view_name) {
  const json wanted = to_json(camera);
  Image image;
  document.work([&](Session& session) {
    const std::optional<Camera> given =
        wanted.is_null() ? std::nullopt : std::optional(Codec<Camera>::read(wanted, session.scene()));
    const Lighting lighting = lit(session.scene());
    image = session.renderer().render(
        session.scene(), resolve_view(session.scene(), given, view_name, width, height, samples), {}, &lighting);
  });
  return py::array_t<std::uint8_t>({image.height, image.width, 3}, image.rgb.data());
}

py::list nodes_of(PyDocument& document) {
  py::list result;
  const Scene scene = document.scene();
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const NodeId parent = parent_of(scene, placed.node->id);
    py::array_t<double> to_world({4, 4});
    auto matrix = to_world.mutable_unchecked<2>();
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) matrix(row, column) = placed.to_world.matrix()(row, column);
    py::dict node;
    node["id"] = static_cast<std::uint64_t>(placed.node->id);
    node["name"] = placed.node->name;
    node["parent"] = parent == NodeId::none ? py::object(py::none()) : py::str(find(scene, parent)->name);
    node["visible"] = placed.visible;
    node["locked"] = placed.locked;
    node["triangles"] = placed.node->object ? placed.node->object->triangle_count() : 0;
    node["to_world"] = to_world;
    result.append(node);
  }
  return result;
}

// Applies the edit `op`; fields that are None are omitted. Returns the selections of all objects if the edit changes
// them.
py::object edit_with(PyDocument& document, const std::string& op, const py::dict& fields) {
  json line = to_json(fields);
  line["op"] = op;
  const Edit edit = edit_once(document, line);
  return edit.type().selects ? py::object(selections_of(document)) : py::none();
}

std::vector<std::string> export_with(PyDocument& document, const py::dict& fields) {
  const json line = to_json(fields);
  std::vector<std::string> notes;
  document.work([&](Session& session) {
    const auto action = read_action<ExportAction>(line, session.scene());
    if (!action.plain) {
      std::error_code error;
      const bool replaces = std::filesystem::exists(action.out, error);
      notes = write_export(session, action).notes;
      if (replaces) notes.push_back(action.out + " existed already and was replaced");
      return;
    }
    notes = notes_of(session, action);
  });
  return notes;
}

// Runs the action T with these fields and returns its messages.
template <class T>
std::vector<std::string> written_with(PyDocument& document, const py::dict& fields) {
  const json line = to_json(fields);
  std::vector<std::string> notes;
  document.work([&](Session& session) { notes = notes_of(session, read_action<T>(line, session.scene())); });
  return notes;
}

void add_history_methods(py::class_<PyDocument>& type) {
  type.def(
      "edit", [](PyDocument& document, const py::dict& line) { edit_once(document, to_json(line)); }, py::arg("edit"),
      "Applies one edit, given as a line of a script.");
  type.def(
      "edits",
      [](PyDocument& document) {
        py::list lines;
        for (const Edit& edit : document.edits()) lines.append(to_python(rebake::to_json(edit)));
        return lines;
      },
      "The edits so far, as lines of a script; nodes by id.");
  type.def(
      "undo",
      [](PyDocument& document) {
        bool done = false;
        document.work([&](Session& session) { done = session.document.undo(1, session.progress); });
        return done;
      },
      "Undoes one edit. False if there is none.");
  type.def(
      "redo",
      [](PyDocument& document) {
        bool done = false;
        document.work([&](Session& session) { done = session.document.redo(1, session.progress); });
        return done;
      },
      "Redoes one edit. False if there is none.");
  type.def(
      "keep_journal",
      [](PyDocument& document, const std::filesystem::path& path) {
        document.work([&](Session& session) { session.document.keep_journal(path); });
      },
      py::arg("path"), "Begins a journal: from now on, each edit is on the disk before it returns.");
  type.def("discard_journal",
           [](PyDocument& document) { document.work([](Session& session) { session.document.discard_journal(); }); });
}

// Methods whose names, types and defaults are visible to help() and inspect.
void add_edit_methods(py::class_<PyDocument>& type) {
  type.def("_edit", &edit_with);
  type.def("_export", &export_with);
  type.def("_publish", &written_with<PublishAction>);
  type.def("_train_light", &written_with<TrainLightAction>);
  type.def("_use_light_model", &written_with<UseLightModelAction>);
  type.def("_forget_light_model", &written_with<ForgetLightModelAction>);
  type.def("_write_picture", &written_with<RenderAction>);
  type.def("_film", &written_with<FilmAction>);
  type.def("_compare_photographs", &written_with<ComparePhotographsAction>);
  py::dict scope;
  scope["__builtins__"] = py::module_::import("builtins");
  scope["__name__"] = "rebake";
  py::exec(python_methods(), scope);
  const py::object methods = scope["Methods"];
  for (const std::string& name : python_method_names()) type.attr(name.c_str()) = methods.attr(name.c_str());
}

}  // namespace

void add_document_methods(py::class_<PyDocument>& type) {
  type.def_property_readonly("nodes", &nodes_of, "Every node: id, name, parent, visible, locked, triangles, to_world.");
  type.def_readwrite(
      "progress", &PyDocument::progress,
      "None, or a function called with the present task and its share, 0 to 1; an exception cancels the work.");
  add_history_methods(type);
  type.def(
      "save",
      [](PyDocument& document, const std::filesystem::path& path) {
        std::vector<std::string> warnings;
        document.work([&](Session& session) {
          if (path.extension() != ".rebake") {
            // Another spelling of the extension would make a scene folder of that name.
            std::string lower = path.extension().string();
            std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
            if (lower == ".rebake") throw FileError(path, "must end in .rebake, in small letters, to be a project");
            warnings = notes_of(session, SaveAction{path.string()});
            return;
          }
          for (const std::string& warning : session.document.save(path, session.progress).warnings)
            warnings.push_back("warning: " + warning);
        });
        warn_of_notes(warnings);
      },
      py::arg("path"),
      "Writes a project (.rebake), or a scene folder with all nodes. Another project with more edits is not replaced.");
  type.def("render", &render_picture, py::arg("width") = 800, py::arg("height") = 800, py::arg("samples") = 4,
           py::arg("camera") = py::none(), py::arg("view") = "", "Renders a picture, uint8, height × width × 3.");
  add_edit_methods(type);
}

}  // namespace rebake
