#include "editor/edits/stored_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

const Camera& stored_view(const Scene& scene, const std::string& name, const char* field) {
  if (const auto found = scene.views.find(name); found != scene.views.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, camera] : scene.views) names.push_back(known);
  throw FieldError(field, names.empty()
                              ? fmt::format("there is no view \"{}\"; store it with the view edit first", name)
                              : fmt::format("there is no view \"{}\"; there are {}", name, fmt::join(names, ", ")));
}

}  // namespace rebake
