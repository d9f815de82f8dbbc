#pragma once

#include <memory>

#include "editor/edits/deform/cage.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// Makes a cage around the selected triangles (or a node), drags its points, and applies what that does as one edit.
class CageTool final : public ViewTool {
 public:
  CageTool();
  ~CageTool() override;
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const Desk& desk, std::vector<Guides::Line>& lines) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool busy() const override { return dragging_ || boxing_; }
  void cancel(Desk& desk) override;

 private:
  struct Bound;
  void make(Desk& desk);
  void apply(Desk& desk);
  bool fits(const Desk& desk) const;
  void preview(Desk& desk);
  int point_at(const Lens& lens, const Vec2& at) const;

  CageDeform edit_;  ///< what the options say
  bool wraps_ = false;
  int cells_[3] = {2, 2, 2};
  float coarseness_ = 0.1F, softness_ = 0;
  std::shared_ptr<const Bound> bound_;  ///< null before a cage was made
  std::vector<Vec3> moved_, before_;    ///< cage points now, and when the drag began
  std::vector<std::uint8_t> picked_;
  bool dragging_ = false, boxing_ = false;  ///< points are dragged; a box is drawn to pick some
  int held_ = -1;
  Vec2 from_{0, 0}, to_{0, 0};
};

}  // namespace rebake
