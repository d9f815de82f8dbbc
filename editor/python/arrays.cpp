// Arrays of class Document: triangles, texels and selections as NumPy views.
#include <fmt/format.h>
#include <pybind11/numpy.h>

#include "editor/edits/select/select_triangles.h"
#include "editor/fields/codec.h"
#include "editor/python/json_python.h"
#include "editor/python/py_document.h"

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

}  // namespace

py::dict selections_of(PyDocument& document) {
  py::dict result;
  for (const PlacedNode& placed : placed_nodes(document.scene()))
    if (placed.node->object) result[py::str(placed.node->name)] = mask_of(placed);
  return result;
}

void add_array_methods(py::class_<PyDocument>& type) {
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
}

}  // namespace rebake
