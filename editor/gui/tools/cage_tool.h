#pragma once

#include <functional>
#include <memory>

#include "editor/edits/deform/cage.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// Makes a cage around the selected triangles (or a node) and drags its points. Every release is a step of the
/// document's history: the first an edit, each later one a revision of it (Document::revise).
class CageTool final : public ViewTool {
 public:
  CageTool();
  ~CageTool() override;
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const Desk& desk, Guides& guides) const override;
  void options(Desk& desk) override;
  bool busy() const override { return dragging_ || boxing_; }
  void cancel(Desk& desk) override;
  void leave(Desk& desk) override;

 private:
  struct Bound;
  using Points = std::vector<Vec3>;
  void make(Desk& desk);
  CageDeform edit_for(const Points& points) const;
  void commit(Desk& desk);
  void follow(Desk& desk);
  void preview(Desk& desk);
  void drag(Desk& desk, const Lens& lens, const Pointer& pointer);
  /// What the drag makes of a point that is picked.
  std::function<Vec3(const Vec3&)> motion(const Lens& lens, const Pointer& pointer) const;
  void pick_inside(const Desk& desk, const Lens& lens);
  /// Whether a cage point looks towards the eye.
  std::vector<std::uint8_t> in_front(const Lens& lens) const;
  void unbind();
  bool shown() const { return bound_ && !asleep_; }
  int point_at(const Desk& desk, const Lens& lens, const Vec2& at) const;

  CageDeform edit_;  ///< what the options say
  bool wraps_ = false;
  enum class Grip { move, turn, scale };
  Grip grip_ = Grip::move;  ///< what dragging does to the picked points
  int symmetric_ = 0;       ///< 0: no; 1 to 3: both sides of the cage's middle along x, y, z
  int cells_[3] = {2, 2, 2};
  float coarseness_ = 0.1F, softness_ = 0;
  std::shared_ptr<const Bound> bound_;  ///< null before a cage was made
  bool asleep_ = false;                 ///< the document holds none of the cage's steps now; redo may return to them
  std::vector<Points> steps_;           ///< the cage's points at rest, and after each release
  std::size_t at_ = 0;                  ///< which of them the document holds
  Points moved_, before_;               ///< cage points now, and when the drag began
  std::vector<std::uint8_t> picked_;
  bool dragging_ = false, boxing_ = false;  ///< points are dragged; a box or a line is drawn to pick some
  bool lassoes_ = false;                    ///< a line
  std::vector<Vec2> line_;
  int held_ = -1;
  Vec2 from_{0, 0}, to_{0, 0};
};

}  // namespace rebake
