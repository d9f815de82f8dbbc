#pragma once

#include <functional>
#include <memory>

#include "editor/edits/deform/cage.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// Deforms the selected triangles, or a node, by dragging the points of a cage around them. Each release is a step of
/// the document's history: the first an edit, each later one a revision of it (Document::revise).
class CageTool final : public ViewTool {
 public:
  CageTool();
  ~CageTool() override;
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const ToolContext& editor, Guides& guides) const override;
  void options(ToolContext& editor) override;
  bool busy() const override { return dragging_ || selecting_region_; }
  void cancel(ToolContext& editor) override;
  void leave(ToolContext& editor) override;

 private:
  struct Bound;
  using Points = std::vector<Vec3>;
  /// Builds a cage and binds the target to it, on the worker.
  void make(ToolContext& editor);
  /// The edit that moves the cage's points to `points`.
  CageDeform edit_for(const Points& points) const;
  /// Makes or revises the edit.
  void commit(ToolContext& editor);
  /// Synchronises the cage with the document.
  void follow(ToolContext& editor);
  /// Requests a preview.
  void preview(ToolContext& editor);
  /// Moves the points in one frame of a drag.
  void drag(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer);
  /// The drag's transform of selected points: maps a position at the start of the drag to the current one (world
  /// space).
  std::function<Vec3(const Vec3&)> motion(const ViewportProjection& lens, const Pointer& pointer) const;
  /// Selects the points in the box or lasso.
  void pick_inside(const ToolContext& editor, const ViewportProjection& lens);
  /// Per cage point: 1 if its normal faces the eye.
  std::vector<std::uint8_t> in_front(const ViewportProjection& lens) const;
  /// Removes the cage; its edit stays.
  void unbind();
  bool shown() const { return bound_ && !hidden_; }
  /// Index of the cage point near a viewport pixel; −1 if there is none.
  int point_at(const ToolContext& editor, const ViewportProjection& lens, const Vec2& at) const;

  CageDeform edit_;     ///< options for the next cage
  bool wraps_ = false;  ///< the next cage is a wrap, not a lattice
  enum class DragTransform { move, turn, scale };
  DragTransform grip_ = DragTransform::move;  ///< transform that a drag applies to the selected points
  int symmetric_ = 0;                         ///< 0: off; 1, 2, 3: mirror drags across the cage's centre along x, y, z
  int cells_[3] = {2, 2, 2};                  ///< lattice cells along x, y, z
  float coarseness_ = 0.1F, softness_ = 0;    ///< wrap coarseness; soft-selection radius / cage diagonal
  std::shared_ptr<const Bound> bound_;        ///< null until a cage is made
  bool hidden_ = false;               ///< hidden: the document has none of the cage's steps; redo may return to one
  std::vector<Points> steps_;         ///< cage points at rest, and after each release
  std::size_t at_ = 0;                ///< index into steps_ of the state that the document has
  Points moved_, before_;             ///< current cage points, and those at the start of the drag
  std::vector<NodePtr> roots_;        ///< of the scene at the start of the drag
  std::vector<std::uint8_t> picked_;  ///< per cage point: 1 if selected
  bool dragging_ = false, selecting_region_ = false;  ///< points are being dragged; a box or lasso is being drawn
  bool region_is_lasso_ = false;                      ///< the region is a lasso, not a box
  std::vector<Vec2> line_;                            ///< the lasso, viewport pixels
  int held_ = -1;                                     ///< index of the dragged point; −1: none
  Vec2 from_{0, 0}, to_{0, 0};                        ///< start of the drag, or corners of the box; viewport pixels
};

}  // namespace rebake
