#include "mesh_ops/base/module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

namespace rebake {

namespace fs = std::filesystem;

ModuleSymbol module_symbol(const std::string& file, const std::string& name) {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&module_symbol), &info) == 0) return {};
  // For the executable, the name may be the command that started it, without a folder.
  fs::path own = info.dli_fname;
  if (!own.has_parent_path()) own = fs::read_symlink("/proc/self/exe");
  const fs::path folder = fs::absolute(own).parent_path();
  for (const char* place : {".", "../lib/rebake", "../../rebake"}) {
    const fs::path path = (folder / place / file).lexically_normal();
    if (std::error_code error; !fs::exists(path, error)) continue;
    void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* symbol = handle != nullptr ? dlsym(handle, name.c_str()) : nullptr;
    if (symbol == nullptr) return {nullptr, fmt::format("{} cannot be loaded: {}", path.string(), dlerror())};
    return {symbol, ""};
  }
  return {};
}

}  // namespace rebake
