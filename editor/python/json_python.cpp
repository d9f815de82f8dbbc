#include "editor/python/json_python.h"

#include <pybind11/numpy.h>

#include "mesh_ops/base/error.h"

namespace py = pybind11;
using nlohmann::json;

namespace rebake {

namespace {

class Reader {
 public:
  json read(const py::handle& value, int depth) {
    constexpr int deepest = 32;
    constexpr std::size_t most = 10'000'000;
    if (depth > deepest) throw FieldError(field_, "is nested deeper than 32 levels, or contains itself");
    if (++count_ > most) throw FieldError(field_, "contains more than ten million values, or is endless");
    if (value.is_none()) return nullptr;
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
    if (py::isinstance<py::int_>(value)) return whole(value);
    if (py::isinstance<py::float_>(value)) return value.cast<double>();
    if (py::isinstance<py::str>(value)) return text(value);
    if (py::hasattr(value, "__fspath__")) return text(value.attr("__fspath__")());
    if (py::isinstance<py::dict>(value)) {
      json object = json::object();
      for (const auto& [key, entry] : value.cast<py::dict>()) {
        const std::string name = text(key);
        if (depth == 0) field_ = name;
        if (!entry.is_none()) object[name] = read(entry, depth + 1);
      }
      return object;
    }
    if (py::isinstance<py::array>(value) || py::hasattr(value, "tolist"))
      return read(value.attr("tolist")(), depth + 1);
    if (py::isinstance<py::sequence>(value)) {
      json list = json::array();
      // Uses the iterator, because len() may be wrong.
      for (const auto& entry : value) list.push_back(read(entry, depth + 1));
      return list;
    }
    throw py::type_error("a field cannot be a " + py::str(value.get_type()).cast<std::string>());
  }

 private:
  std::string text(const py::handle& value) const {
    try {
      return value.cast<std::string>();
    } catch (const py::cast_error&) {
      PyErr_Clear();
      throw FieldError(field_, "is not valid UTF-8 text, which journals and projects need");
    }
  }
  json whole(const py::handle& value) const {
    try {
      const auto number = value.cast<std::int64_t>();
      return number < 0 ? json(number) : json(static_cast<std::uint64_t>(number));
    } catch (const py::cast_error&) {
      throw FieldError(field_, "is a whole number of more than 64 bits");
    }
  }
  std::string field_ = "value";  // top-level field that is being read, for messages
  std::size_t count_ = 0;        // number of values read
};

}  // namespace

json to_json(const py::handle& value) { return Reader().read(value, 0); }

py::object to_python(const json& value) {
  switch (value.type()) {
    case json::value_t::boolean:
      return py::bool_(value.get<bool>());
    case json::value_t::number_integer:
      return py::int_(value.get<std::int64_t>());
    case json::value_t::number_unsigned:
      return py::int_(value.get<std::uint64_t>());
    case json::value_t::number_float:
      return py::float_(value.get<double>());
    case json::value_t::string:
      return py::str(value.get<std::string>());
    case json::value_t::array: {
      py::list list;
      for (const json& entry : value) list.append(to_python(entry));
      return list;
    }
    case json::value_t::object: {
      py::dict object;
      for (const auto& [key, entry] : value.items()) object[py::str(key)] = to_python(entry);
      return object;
    }
    default:
      return py::none();
  }
}

}  // namespace rebake
