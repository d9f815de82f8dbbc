#pragma once

#include <optional>

namespace rebake {

enum class ToolKind { pick, rectangle, lasso, polygon, brush, flood, erase, move, turn, scale, cage, bend };

/// Which tool is in hand, and how tools behave.
struct ToolState {
  ToolKind kind = ToolKind::pick;
  std::optional<ToolKind> drag_begins;  ///< takes hold of its target at once, without a button
  std::optional<ToolKind> before;       ///< to come back to after such a drag
  bool visible_only = true;             ///< select what is seen, not what lies behind it
  bool local_axes = false;
};

}  // namespace rebake
