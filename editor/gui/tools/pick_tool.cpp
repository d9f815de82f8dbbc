#include "editor/gui/tools/pick_tool.h"

#include <memory>

#include "editor/edits/select/select_like.h"

namespace rebake {

namespace {

void take(Desk& desk, const std::optional<Picked>& picked, const Pointer& pointer, bool floods) {
  if (floods) {
    if (!picked) return;
    SelectLike like;
    like.node = NodeRef{picked->node};
    like.point = picked->world;
    like.color = desk.settings.likeness;
    like.mode = select_mode(pointer);
    desk.edit(like);
    return;
  }
  if (!pointer.shift && !pointer.control) desk.active.clear();
  if (!picked) return;
  if (pointer.control)
    desk.active.erase(picked->node);
  else
    desk.active.insert(picked->node);
}

}  // namespace

void PickTool::pointer(Desk& desk, const Lens& lens, const Pointer& pointer) {
  constexpr double click_reach = 4;  // pixels; farther is a drag
  if (pointer.pressed && pointer.inside) pressed_at_ = pointer.at;
  if (!pointer.released || (pressed_at_ - pointer.at).norm() > click_reach) return;
  pressed_at_ = Vec2(-1e9, -1e9);
  // On the worker: what was not looked through yet takes its time.
  auto picked = std::make_shared<std::optional<Picked>>();
  desk.jobs.worker.start(
      "pick", [picked, lens, at = pointer.at](Session& session) { *picked = pick(session.scene(), lens, at); },
      [&desk, picked, pointer, floods = floods_] { take(desk, *picked, pointer, floods); });
}

void PickTool::options(Desk& desk) {
  if (!floods_) {
    flow_text("click picks a node, dragging turns the view; Shift adds, Ctrl removes");
    return;
  }
  auto likeness = static_cast<float>(desk.settings.likeness);
  ImGui::SetNextItemWidth(160);
  if (ImGui::SliderFloat("difference of colour", &likeness, 0, 1))
    desk.settings.likeness = static_cast<double>(likeness);
  flow_text("click what it shall be like; Shift adds, Ctrl removes, both intersect");
}

}  // namespace rebake
