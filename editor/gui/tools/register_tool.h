#pragma once

#include <set>

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Moves the picked node onto another capture of the same place by pairs of clicked points.
class RegisterTool final : public ViewTool {
 public:
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(ToolContext& editor, const KeyPress& press) override;
  void options(ToolContext& editor) override;
  void cancel(ToolContext& editor) override;

 private:
  /// Adds a clicked point: first one of the node that moves, then its counterpart.
  void add(ToolContext& editor, const PickHit& hit);
  void remove_last();
  /// Residuals of the pairs, or the reason why they determine no motion.
  std::string fit_words() const;

  std::vector<NodePtr> roots_;     ///< scene of the points, which are forgotten when it changes
  NodeId node_ = NodeId::none;     ///< the node that moves
  std::vector<Vec3> from_, onto_;  ///< points of it, and their counterparts; world space
  Click click_;
  bool scale_ = true, refine_ = true;
};

}  // namespace rebake
