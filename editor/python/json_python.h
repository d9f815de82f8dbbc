#pragma once

#include <pybind11/pybind11.h>

#include <nlohmann/json.hpp>

namespace rebake {

/// Fields given in Python as JSON: numbers, text, paths, arrays, lists and dicts of them, nested 32 deep at most and of
/// at most ten million values together, so that what contains itself or never ends is refused. Throws FieldError, and
/// TypeError for what is nothing of these.
nlohmann::json to_json(const pybind11::handle& value);

pybind11::object to_python(const nlohmann::json& value);

}  // namespace rebake
