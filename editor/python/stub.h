#pragma once

#include <string>
#include <string_view>

namespace rebake {

/// The type stub of the Python module, rebake.pyi: a fixed part, and a method per edit with its fields, types and
/// defaults.
std::string python_stub();

/// Python source of a class Edits with a method per edit, which calls self._edit(op, fields).
std::string python_methods();

/// The name in Python: `as`, `from` and `import`, which are keywords, get a trailing underscore.
std::string python_name(std::string_view name);

}  // namespace rebake
