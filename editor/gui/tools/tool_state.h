#pragma once

#include <map>
#include <optional>

namespace rebake {

/// Tools of the viewport. `flood` selects by colour, `volume` by a box or sphere, `turn` rotates.
enum class ToolKind {
  pick,
  rectangle,
  lasso,
  polygon,
  brush,
  flood,
  volume,
  erase,
  move,
  turn,
  scale,
  cage,
  bend,
  handles,
  ground
};

/// The active tool, and options that tools share.
struct ToolState {
  ToolKind kind = ToolKind::pick;
  std::optional<ToolKind> drag_begins;  ///< tool whose drag begins in the next frame without a button (Blender's keys)
  std::optional<ToolKind> before;       ///< tool to return to after such a drag
  /// Whether the active tool affects only visible triangles or points, not occluded ones.
  bool& visible_only() { return takes_seen.try_emplace(kind, at_first()).first->second; }
  bool visible_only() const { return takes_seen.contains(kind) ? takes_seen.at(kind) : at_first(); }
  /// Default of visible_only(). Cages are edited from all sides.
  bool at_first() const { return kind != ToolKind::cage; }
  std::map<ToolKind, bool> takes_seen;  ///< visible_only() of tools for which it was changed
  bool local_axes = false;              ///< gizmos use the node's axes, not the world's
  bool snaps = false;                   ///< a freely moved node is placed on the surface under the pointer
};

}  // namespace rebake
