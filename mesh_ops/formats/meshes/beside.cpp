#include "mesh_ops/formats/meshes/beside.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace fs = std::filesystem;

fs::path path_beside(const fs::path& folder, std::string name, const fs::path& named_in) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path inside = fs::path(name).lexically_normal();
  const auto refuse = [&] {
    throw FileError(named_in, fmt::format("refers to \"{}\", which is outside its folder: copy it beside", name));
  };
  if (inside.empty() || inside.is_absolute() || *inside.begin() == "..") refuse();
  std::error_code error;
  const fs::path base = folder.empty() ? fs::path(".") : folder;
  const fs::path real = fs::weakly_canonical(base / inside, error), root = fs::weakly_canonical(base, error);
  if (!error && *real.lexically_relative(root).begin() == "..") refuse();
  return inside;
}

std::string read_beside(const fs::path& folder, const fs::path& name, const fs::path& named_in) {
  std::error_code error;
  if (!fs::is_regular_file(folder / name, error))
    throw FileError(named_in, fmt::format("refers to \"{}\", which is not there: copy it beside, or change the name",
                                          name.string()));
  return read_file(folder / name);
}

std::shared_ptr<const Origin> origin_of_file(const fs::path& file, const char* format,
                                             std::vector<std::string> assumptions) {
  auto origin = std::make_shared<Origin>();
  origin->folder = absolute_path(file);
  origin->format = format;
  origin->assumptions = std::move(assumptions);
  return origin;
}

}  // namespace rebake
