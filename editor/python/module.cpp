// The Python module: class Document with a method per edit, and its arrays as NumPy views.
#include <fmt/format.h>
#include <pybind11/eval.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <mutex>
#include <optional>
#include <utility>

#include "editor/actions/export_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/save.h"
#include "editor/actions/save_project.h"
#include "editor/actions/session.h"
#include "editor/actions/views.h"
#include "editor/document/project.h"
#include "editor/document/result_store.h"
#include "editor/edits/deform/cage.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/select/select_triangles.h"
#include "editor/edits/support.h"
#include "editor/python/json_python.h"
#include "editor/python/stub.h"
#include "editor/python/work.h"
#include "mesh_ops/deform/cage_deformation.h"
#include "mesh_ops/deform/wrap.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_folder.h"
#include "render/picture.h"

namespace py = pybind11;
using nlohmann::json;

namespace rebake {

namespace {

// A read-only NumPy view; the array owns `owner`, which keeps the data alive.
template <class T, class Owner>
py::array view_of(const T* data, std::vector<py::ssize_t> shape, Owner owner) {
  const py::capsule keeper(new Owner(std::move(owner)), [](void* kept) { delete static_cast<Owner*>(kept); });
  py::array_t<T> array(std::move(shape), data, keeper);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// A session that Python may use from any thread. All access releases the GIL before it locks the mutex. Readers copy
// the scene, which is cheap.
class PyDocument {
 public:
  PyDocument() = default;
  explicit PyDocument(Document document) { session_.document = std::move(document); }

  py::object progress = py::none();  ///< progress callback, or None

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

PlacedNode node_in(const Scene& scene, const py::object& name) {
  const PlacedNode placed = *find_placed(scene, Codec<NodeRef>::read(to_json(name), scene).id);
  if (!placed.node->object)
    throw EditError("node \"" + placed.node->name + "\" is a group without triangles; name an object");
  return placed;
}

TextureSet set_in(const Scene& scene, const py::object& name, std::size_t index) {
  const PlacedNode placed = node_in(scene, name);
  const auto& sets = placed.node->object->sets;
  if (index >= sets.size())
    throw FieldError("texture_set",
                     fmt::format("is out of range: \"{}\" has {}, counted from 0", placed.node->name, sets.size()));
  return sets[index];
}

py::array mask_of(const PlacedNode& placed) {
  const std::size_t count = placed.node->object->triangle_count();
  py::array_t<bool> result(static_cast<py::ssize_t>(count));
  auto flags = result.mutable_unchecked<1>();
  for (std::size_t f = 0; f < count; ++f)
    flags(static_cast<py::ssize_t>(f)) = placed.node->selection && (*placed.node->selection)[f] != 0;
  return result;
}

py::dict selections_of(PyDocument& document) {
  py::dict result;
  for (const PlacedNode& placed : placed_nodes(document.scene()))
    if (placed.node->object) result[py::str(placed.node->name)] = mask_of(placed);
  return result;
}

Edit edit_once(PyDocument& document, const json& line) {
  std::optional<Edit> made;
  document.work([&](Session& session) {
    session.document.protect_files_of(line);
    check_boxes(line);
    made = read_edit(line, session.scene());
    session.edit(*made);
  });
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

py::list tiles_of(PyDocument& document, const py::object& name, std::size_t index) {
  const TextureSet set = set_in(document.scene(), name, index);
  py::list rows;
  for (int row = 0; row < set.texels->tile_rows(); ++row) {
    py::list columns;
    for (int column = 0; column < set.texels->tile_columns(); ++column) {
      const auto texels = set.texels->tile(column, row)->texels();
      columns.append(view_of(reinterpret_cast<const std::uint8_t*>(texels->data()),
                             {TexelTile::size, TexelTile::size, 8}, texels));
    }
    rows.append(columns);
  }
  return rows;
}

py::array texture_of(PyDocument& document, const py::object& name, std::size_t index) {
  const TextureSet set = set_in(document.scene(), name, index);
  const int width = set.texels->width(), height = set.texels->height();
  py::array_t<std::uint8_t> result({height, width, 8});
  const TexelReader texels(*set.texels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; x += TexelTile::size)
      std::memcpy(result.mutable_data(y, x, 0), texels.row_part(x, y),
                  static_cast<std::size_t>(std::min(TexelTile::size, width - x)) * sizeof(Texel));
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

py::object select_mask(PyDocument& document, const py::object& node, const py::array_t<bool>& mask,
                       const std::string& mode) {
  const PlacedNode placed = node_in(document.scene(), node);
  const std::size_t count = placed.node->object->triangle_count();
  if (mask.ndim() != 1 || static_cast<std::size_t>(mask.size()) != count)
    throw FieldError(
        "mask", fmt::format("must be a 1-D array of {} values, one per triangle of \"{}\"", count, placed.node->name));
  SelectTriangles edit{{placed.node->id}, {}, Codec<SelectMode>::read(json(mode), {})};
  const auto flags = mask.unchecked<1>();
  for (std::uint64_t f = 0; f < count; ++f) {
    if (!flags(static_cast<py::ssize_t>(f))) continue;
    auto& ranges = edit.triangles.ranges;
    if (!ranges.empty() && ranges.back().second + 1 == f)
      ranges.back().second = f;
    else
      ranges.emplace_back(f, f);
  }
  document.work([&](Session& session) { session.edit(edit); });
  return selections_of(document);
}

// Checks that an argument is an n × 3 array whose dtype kind is one of `kinds`. Throws FieldError for the argument
// `name`.
py::array checked_array(const py::object& given, const char* name, const char* kinds, const char* numbers) {
  const py::array array = py::array::ensure(given);
  if (!array) PyErr_Clear();
  if (!array || std::string_view(kinds).find(array.dtype().kind()) == std::string_view::npos || array.ndim() != 2 ||
      array.shape(1) != 3)
    throw FieldError(name, fmt::format("must be an array of n × 3 {}, not {}", numbers,
                                       array ? fmt::format("{} of shape {}", py::str(array.dtype()).cast<std::string>(),
                                                           py::str(array.attr("shape")).cast<std::string>())
                                             : py::str(py::type::of(given)).cast<std::string>()));
  return array;
}

std::vector<Vec3> points_from(const py::object& given, const char* name) {
  const py::array_t<double, py::array::c_style | py::array::forcecast> array =
      checked_array(given, name, "fiu", "numbers");
  std::vector<Vec3> points;
  const auto rows = array.unchecked<2>();
  for (py::ssize_t k = 0; k < rows.shape(0); ++k) {
    points.emplace_back(rows(k, 0), rows(k, 1), rows(k, 2));
    if (!points.back().allFinite()) throw FieldError(name, fmt::format("row {} is not finite", k));
  }
  return points;
}
std::vector<Face> faces_from(const py::object& given, std::size_t points) {
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> array =
      checked_array(given, "faces", "iu", "whole numbers");
  std::vector<Face> faces;
  const auto rows = array.unchecked<2>();
  for (py::ssize_t k = 0; k < rows.shape(0); ++k) {
    Face& face = faces.emplace_back();
    for (py::ssize_t corner = 0; corner < 3; ++corner) {
      const std::int64_t number = rows(k, corner);
      if (number < 0 || static_cast<std::uint64_t>(number) >= points)
        throw FieldError("faces",
                         fmt::format("row {} contains vertex {}; there are {}, counted from 0", k, number, points));
      face[static_cast<std::size_t>(corner)] = static_cast<std::uint32_t>(number);
    }
  }
  return faces;
}
py::array_t<double> array_of(const std::vector<Vec3>& points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  auto rows = array.mutable_unchecked<2>();
  for (std::size_t k = 0; k < points.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) rows(static_cast<py::ssize_t>(k), axis) = points[k][axis];
  return array;
}

py::array_t<double> move_by_cage(const py::object& points, const py::object& vertices, const py::object& faces,
                                 const py::object& moved, const std::string& kind, int resolution) {
  const std::vector<Vec3> places = points_from(points, "points"), targets = points_from(moved, "moved"),
                          corners = points_from(vertices, "vertices");
  const Cage cage = checked_cage({corners, faces_from(faces, corners.size())});
  if (targets.size() != cage.vertices.size()) throw FieldError("moved", "must have as many rows as vertices");
  const CageCoordinates coordinates = Codec<CageCoordinates>::read(json(kind), {});
  std::vector<Vec3> moved_places;
  run_without_gil(py::none(), [&](const Progress& progress) {
    const auto weights = coordinates_of(cage, coordinates, resolution, progress);
    moved_places = deform_points(*weights, cage, targets, places, false, progress).points;
  });
  for (std::size_t k = 0; k < moved_places.size(); ++k)
    if (!moved_places[k].allFinite())
      throw FieldError("points", fmt::format("row {} is too far from the cage for coordinates", k));
  return array_of(moved_places);
}

py::tuple wrap_triangles(const py::object& points, const py::object& faces, double coarseness) {
  const std::vector<Vec3> places = points_from(points, "points");
  const TriangleList triangles{places, faces_from(faces, places.size())};
  Cage cage;
  run_without_gil(py::none(), [&](const Progress& progress) { cage = wrap(triangles, coarseness, progress); });
  py::array_t<std::uint32_t> numbers({static_cast<py::ssize_t>(cage.faces.size()), py::ssize_t{3}});
  if (!cage.faces.empty()) std::memcpy(numbers.mutable_data(), cage.faces.data(), cage.faces.size() * sizeof(Face));
  return py::make_tuple(array_of(cage.vertices), numbers);
}

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
  Import import;
  import.path = path.string();
  import.axes = Codec<Axes>::read(json(axes), {});
  run_without_gil(callback, [&](const Progress& progress) {
    if (is_project_file(path)) {
      opened = Document::open(path, links, progress);
      return;
    }
    opened.emplace();
    opened->edit(import, progress);
  });
  auto document = std::make_unique<PyDocument>(std::move(*opened));
  document->progress = callback;
  return document;
}

std::unique_ptr<PyDocument> recover_document(const std::filesystem::path& journal, const py::dict& sources,
                                             const py::object& callback) {
  const SourceLinks links = links_from(sources);
  std::optional<Document::Recovered> recovered;
  run_without_gil(callback, [&](const Progress& progress) { recovered = Document::recover(journal, links, progress); });
  if (!recovered->document.keeps_journal() &&
      PyErr_WarnEx(PyExc_UserWarning,
                   (journal.string() + " is not changed, and further edits are not in a journal: call "
                                       "keep_journal with another file, or save")
                       .c_str(),
                   1) != 0)
    throw py::error_already_set();
  for (const std::string& lost : recovered->lost)
    if (PyErr_WarnEx(PyExc_UserWarning, ("not recovered: " + lost).c_str(), 1) != 0) throw py::error_already_set();
  auto document = std::make_unique<PyDocument>(std::move(recovered->document));
  document->progress = callback;
  return document;
}

}  // namespace

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
  type.def_property_readonly("nodes", &nodes_of, "Every node: id, name, parent, visible, locked, triangles, to_world.");
  type.def_readwrite(
      "progress", &PyDocument::progress,
      "None, or a function called with the present task and its share, 0 to 1; an exception cancels the work.");
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
  type.def(
      "save",
      [](PyDocument& document, const std::filesystem::path& path) {
        std::vector<std::string> warnings;
        document.work([&](Session& session) {
          if (path.extension() == ".rebake")
            warnings = session.document.save(path, session.progress);
          else
            run(session, SaveAction{path.string()});
        });
        for (const std::string& warning : warnings)
          if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 1) != 0) throw py::error_already_set();
      },
      py::arg("path"), "Writes a project (.rebake), or a scene folder with all nodes.");
  type.def(
      "export",
      [](PyDocument& document, const std::filesystem::path& path, const py::object& layout, const std::string& format,
         bool plain, const py::object& width, const py::object& way, const std::string& keep,
         std::optional<double> psnr, double seconds, const std::filesystem::path& report) {
        ExportAction action;
        action.out = path.string();
        action.format = format;
        if (!layout.is_none()) action.layout = Codec<Layout>::read(to_json(layout), {});
        action.plain = plain;
        action.width = Codec<FuseWidth>::read(to_json(width), {});
        if (!way.is_none()) action.way = Codec<FuseMethod>::read(to_json(way), {});
        action.keep = keep;
        action.psnr = psnr;
        action.seconds = seconds;
        action.report = report.string();
        std::vector<std::string> notes;
        document.work([&](Session& session) {
          if (!plain) {
            check_not_plain(action);
            const ExportOptions options{action.layout, session.document.sources()};
            notes = format_named(format).write(session.scene(), path, options, session.progress).notes;
            return;
          }
          const auto say = std::exchange(session.say, [&notes](const std::string& line) { notes.push_back(line); });
          try {
            run(session, action);
          } catch (...) {
            session.say = say;
            throw;
          }
          session.say = say;
        });
        return notes;
      },
      py::arg("path"), py::arg("layout") = py::none(), py::arg("format") = "mobilenerf", py::arg("plain") = false,
      py::arg("width") = "auto", py::arg("way") = py::none(), py::arg("keep") = "auto", py::arg("psnr") = py::none(),
      py::arg("seconds") = 0, py::arg("report") = "",
      "Exports in the MobileNeRF format or another; returns notes about conversions and losses.");
  type.def("render", &render_picture, py::arg("width") = 800, py::arg("height") = 800, py::arg("samples") = 4,
           py::arg("camera") = py::none(), py::arg("view") = "", "Renders a picture, uint8, height × width × 3.");
  type.def(
      "selection",
      [](PyDocument& document, const py::object& node) { return mask_of(node_in(document.scene(), node)); },
      py::arg("node"), "The selected triangles of an object, as a boolean mask.");
  type.def(
      "vertices",
      [](PyDocument& document, const py::object& node, std::size_t index) {
        const auto positions = set_in(document.scene(), node, index).soup.shared_positions();
        return view_of(positions->data()->data(), {static_cast<py::ssize_t>(positions->size()), 3}, positions);
      },
      py::arg("node"), py::arg("texture_set") = 0, "Positions in object space, n × 3; a read-only view.");
  type.def(
      "uvs",
      [](PyDocument& document, const py::object& node, std::size_t index) {
        const auto uvs = set_in(document.scene(), node, index).soup.shared_uvs();
        return view_of(uvs->data()->data(), {static_cast<py::ssize_t>(uvs->size()), 2}, uvs);
      },
      py::arg("node"), py::arg("texture_set") = 0, "Texture coordinates, n × 2, v up; a read-only view.");
  type.def(
      "faces",
      [](PyDocument& document, const py::object& node, std::size_t index) {
        const auto faces = set_in(document.scene(), node, index).soup.shared_faces();
        return view_of(faces->data()->data(), {static_cast<py::ssize_t>(faces->size()), 3}, faces);
      },
      py::arg("node"), py::arg("texture_set") = 0, "Vertex numbers, n × 3; a read-only view.");
  type.def("tiles", &tiles_of, py::arg("node"), py::arg("texture_set") = 0,
           "The texels by tile row and column, 256 × 256 × 8 per tile; read-only, unpacked by each call.");
  type.def("texture", &texture_of, py::arg("node"), py::arg("texture_set") = 0,
           "All texels as one array, height × width × 8; a copy.");
  type.def("select_mask", &select_mask, py::arg("node"), py::arg("mask"), py::arg("mode") = "set",
           "Selects an object's triangles by a mask, as returned by selection(); recorded as select_triangles.");
  type.def("_edit", &edit_with);
  // Edits as methods whose names, types and defaults are visible to help() and inspect.
  py::dict scope;
  scope["__builtins__"] = py::module_::import("builtins");
  scope["__name__"] = "rebake";
  py::exec(python_methods(), scope);
  const py::object edits = scope["Edits"];
  for (const EditType* edit : edit_types()) {
    const std::string name = python_name(edit->op);
    type.attr(name.c_str()) = edits.attr(name.c_str());
  }

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
  py::module_::import("atexit").attr("register")(py::cpp_function(&shut_down_workers));
  module.def("move_by_cage", &move_by_cage, py::arg("points"), py::arg("vertices"), py::arg("faces"), py::arg("moved"),
             py::arg("coordinates") = "mean_value", py::arg("resolution") = 32,
             "Deforms points by a closed cage whose vertices move.");
  module.def("wrap", &wrap_triangles, py::arg("points"), py::arg("faces"), py::arg("coarseness") = 0.1,
             "Wraps triangles with a closed cage; returns its vertices and faces.");
  module.def("python_stub", &python_stub, "The module's type stub.");
}

}  // namespace rebake
