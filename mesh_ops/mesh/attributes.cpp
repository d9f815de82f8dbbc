#include "mesh_ops/mesh/attributes.h"

namespace rebake {

Attributes::Shared Attributes::shared(const std::string& name) const {
  for (const auto& [known, attribute] : entries_)
    if (known == name) return attribute;
  return nullptr;
}

Attributes Attributes::with(const std::string& name, Shared attribute) const {
  Attributes result = *this;
  std::erase_if(result.entries_, [&](const auto& entry) { return entry.first == name; });
  if (attribute) result.entries_.emplace_back(name, std::move(attribute));
  std::sort(result.entries_.begin(), result.entries_.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  return result;
}

Attributes Attributes::picked(const std::vector<std::uint32_t>& elements) const {
  Attributes result;
  for (const auto& [name, attribute] : entries_)
    if (Shared picked = attribute->picked(elements)) result.entries_.emplace_back(name, std::move(picked));
  return result;
}

Attributes Attributes::followed_by(std::size_t count, const Attributes& other, std::size_t other_count) const {
  Attributes result;
  for (const auto& [name, attribute] : entries_) {
    const Shared theirs = other.shared(name);
    result = result.with(name, theirs ? attribute->followed_by(*theirs) : attribute->padded(0, other_count));
  }
  for (const auto& [name, attribute] : other.entries_)
    if (!shared(name)) result = result.with(name, attribute->padded(count, 0));
  return result;
}

}  // namespace rebake
