#pragma once

#include <functional>
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
  handles
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
  /// Takes back (-1) or does again (1) a step that is the tool's own; false when there is none. Null without such
  /// steps.
  std::function<bool(int)> own_step;
  int steps_waiting = 0;  ///< that were asked for while another was being taken; back where below 0
  bool local_axes = false;
  bool snaps = false;  ///< what is moved freely is put onto the surface under the pointer
};

}  // namespace rebake
