#pragma once

#include <pybind11/pybind11.h>

#include <nlohmann/json.hpp>

namespace rebake {

/// Converts Python numbers, strings, paths, arrays, sequences and dicts to JSON; drops dict entries that are None.
/// Throws FieldError beyond 32 levels or ten million values, which stops cyclic and endless input, and TypeError for
/// other types.
nlohmann::json to_json(const pybind11::handle& value);

/// Converts JSON to Python objects.
pybind11::object to_python(const nlohmann::json& value);

}  // namespace rebake
