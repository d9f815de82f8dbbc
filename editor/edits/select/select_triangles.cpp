#include "editor/edits/select/select_triangles.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectTriangles& edit) {
  const PlacedNode placed = editable(scene, edit.node.id);
  if (!placed.node->object)
    throw EditError(fmt::format("\"{}\" is a group without triangles; name an object inside it", placed.node->name));
  TriangleSet flags(placed.node->object->triangle_count(), 0);
  for (const auto& [first, last] : edit.triangles.ranges) {
    if (last >= flags.size())
      throw FieldError("triangles", fmt::format("{} is out of range: \"{}\" has {}, counted from 0", last,
                                                placed.node->name, counted(flags.size(), "triangle")));
    std::fill(flags.begin() + static_cast<std::ptrdiff_t>(first), flags.begin() + static_cast<std::ptrdiff_t>(last) + 1,
              std::uint8_t{1});
  }
  return with_selected(scene, {placed}, edit.mode, [&](const PlacedNode&) { return flags; });
}

REBAKE_DESCRIBE_EDIT(
    SelectTriangles, "Selects triangles of an object by number, over its texture sets in order.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "the object");
      visit("triangles", edit.triangles, Need::required, "numbers or ranges, counted from 0");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
