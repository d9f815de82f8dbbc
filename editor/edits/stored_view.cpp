#include "editor/edits/stored_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Natural sort order: runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [&](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t first = at;
      while (at < text.size() && digit(text[at])) ++at;
      return text.substr(first, at - first);
    };
    const std::string m = number(a, i), n = number(b, j);
    if (m != n) return m.size() != n.size() ? m.size() < n.size() : m < n;
  }
  return a.size() - i < b.size() - j;
}

}  // namespace

std::vector<std::string> view_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, camera] : scene.views) names.push_back(name);
  std::stable_sort(names.begin(), names.end(), natural_less);
  return names;
}

const Camera& stored_view(const Scene& scene, const std::string& name, const char* field) {
  if (const auto found = scene.views.find(name); found != scene.views.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, camera] : scene.views) names.push_back(known);
  throw FieldError(field,
                   names.empty()
                       ? fmt::format("there is no view \"{}\"; store it with the view edit first", name)
                       : fmt::format("there is no view \"{}\"; the stored views are {}", name, fmt::join(names, ", ")));
}

}  // namespace rebake
