#pragma once

#include <map>
#include <optional>

namespace rebake {

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

/// Which tool is in hand, and how tools behave.
struct ToolState {
  ToolKind kind = ToolKind::pick;
  std::optional<ToolKind> drag_begins;  ///< takes hold of its target at once, without a button
  std::optional<ToolKind> before;       ///< to come back to after such a drag
  /// Whether the tool in hand takes what is seen only, not what lies behind it.
  bool& visible_only() { return takes_seen.try_emplace(kind, at_first()).first->second; }
  bool visible_only() const { return takes_seen.contains(kind) ? takes_seen.at(kind) : at_first(); }
  bool at_first() const { return kind != ToolKind::cage; }  ///< a cage is held all around
  std::map<ToolKind, bool> takes_seen;                      ///< of tools where it was changed
  bool local_axes = false;
  bool snaps = false;  ///< what is moved freely is put onto the surface under the pointer
};

}  // namespace rebake
