#pragma once

#include <string>

namespace rebake {

/// A symbol of a Rebake module. Modules are shared libraries that depend on large libraries; they are loaded on first
/// use and stay loaded.
struct ModuleSymbol {
  void* symbol = nullptr;  ///< null if the module or the symbol is missing
  std::string problem;     ///< reason why loading failed; empty if the module does not exist
};
/// Looks up symbol `name` of module `file`. Searches the folder of the calling program or library (as built), then
/// lib/rebake below its installation prefix.
ModuleSymbol module_symbol(const std::string& file, const std::string& name);

}  // namespace rebake
