#pragma once

#include <string>

namespace rebake {

/// What a module of ours gives under a name; `symbol` is null where there is none, and `problem` then says why (empty:
/// the module is not there). Modules hold what needs large libraries, and are loaded when that is first asked for. They
/// lie beside the program or library that this code is part of, as it is built, or in lib/rebake below its prefix, as
/// it is installed. A module stays loaded.
struct ModuleSymbol {
  void* symbol = nullptr;
  std::string problem;
};
ModuleSymbol module_symbol(const std::string& file, const std::string& name);

}  // namespace rebake
