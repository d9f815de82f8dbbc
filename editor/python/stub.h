#pragma once

#include <string>
#include <string_view>

namespace rebake {

/// The type stub of the Python module, rebake.pyi: the edits come from the one table, so that editors know each one's
/// fields, types and defaults.
std::string python_stub();

/// Python source of a class Edits whose methods call self._edit(op, fields), one an edit.
std::string python_methods();

/// A name as it stands in Python: words of the language get an underscore.
std::string python_name(std::string_view name);

}  // namespace rebake
