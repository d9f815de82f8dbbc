#pragma once

#include <fmt/format.h>

#include "editor/edits/selecting.h"

namespace rebake {

struct SelectTriangles {
  static constexpr const char* op = "select_triangles";
  static constexpr const char* help = "Selects triangles of an object by their numbers, set after set as in its files.";
  NodeRef node;
  NumberRanges triangles;
  SelectMode mode = SelectMode::set;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "the object");
    visit("triangles", self.triangles, Need::required, "which ones, counted from 0");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
  }
};

inline Scene apply(const Scene& scene, const SelectTriangles& edit) {
  const PlacedNode placed = editable(scene, edit.node.id);
  if (!placed.node->object)
    throw EditError(fmt::format("\"{}\" is a group: it has no triangles of its own", placed.node->name));
  TriangleSet flags(placed.node->object->triangle_count(), 0);
  for (const auto& [first, last] : edit.triangles.ranges) {
    if (last >= flags.size())
      throw FieldError("triangles",
                       fmt::format("{} is too high: \"{}\" has {}", last, placed.node->name, flags.size()));
    std::fill(flags.begin() + static_cast<std::ptrdiff_t>(first), flags.begin() + static_cast<std::ptrdiff_t>(last) + 1,
              std::uint8_t{1});
  }
  return with_selected(scene, {placed}, edit.mode, [&](const PlacedNode&) { return flags; });
}

}  // namespace rebake
