#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// The type stub of the Python module, rebake.pyi: a fixed part, the methods that write files, and a method per edit,
/// with fields, types and defaults.
std::string python_stub();

/// Python source of a class Methods: those that write files, such as export(), which calls self._export(fields),
/// and a method per edit, which calls self._edit(op, fields).
std::string python_methods();
/// The names of these methods.
std::vector<std::string> python_method_names();

/// The name in Python: `as`, `from` and `import`, which are keywords, get a trailing underscore.
std::string python_name(std::string_view name);

}  // namespace rebake
