#pragma once

#include <map>
#include <optional>

namespace rebake {

/// Tools of the viewport. `flood` selects by colour, `volume` by a box or sphere, `rotate` rotates.
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
  rotate,
  scale,
  cage,
  bend,
  handles,
  ground,
  measure,
  register_captures
};

/// The active tool, and options that tools share.
struct ToolState {
  ToolKind kind = ToolKind::pick;
  std::optional<ToolKind> pending_drag;  ///< tool whose drag begins in the next frame without a button (Blender's keys)
  std::optional<ToolKind> before;        ///< tool to return to after such a drag
  /// Whether the active tool affects only visible triangles or points, not occluded ones.
  bool& visible_only() { return visible_only_overrides.try_emplace(kind, default_visible_only()).first->second; }
  bool visible_only() const {
    return visible_only_overrides.contains(kind) ? visible_only_overrides.at(kind) : default_visible_only();
  }
  /// Default of visible_only(). Cages are edited from all sides.
  bool default_visible_only() const { return kind != ToolKind::cage; }
  std::map<ToolKind, bool> visible_only_overrides;  ///< visible_only() of tools for which it was changed
  bool local_axes = false;                          ///< gizmos use the node's axes, not the world's
  bool snap_to_surface = false;                     ///< a freely moved node is placed on the surface under the pointer
};

}  // namespace rebake
