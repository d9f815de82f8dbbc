#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Picks the clicked node; in flood mode, selects triangles of a colour similar to the clicked one.
class PickTool final : public ViewTool {
 public:
  explicit PickTool(bool floods) : floods_(floods) {}
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk&, const Lens&, const Pointer&, ImDrawList&, const ImVec2&) const override {}
  bool wants_scene() const override { return false; }
  void options(Desk& desk) override;
  void cancel(Desk&) override {}

 private:
  bool floods_;
  Click click_;
};

}  // namespace rebake
