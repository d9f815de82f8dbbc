#include "editor/gui/tools/pick_tool.h"

#include <memory>
#include <set>

#include "editor/edits/select/select_like.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

void take(Desk& desk, const std::optional<Picked>& picked, const Pointer& pointer, bool floods) {
  if (floods) {
    if (!picked) return;
    std::set<NodeId> touched;
    for (const std::optional<NodeRef>& node : desk.scope())
      if (node) touched.insert(node->id);
    if (!touched.empty() && !touched.contains(picked->node)) {
      desk.messages.say("Nothing picked lies there: tools work on what is picked.");
      return;
    }
    SelectLike like;
    like.node = NodeRef{picked->node};
    like.point = picked->world;
    like.color = desk.settings.likeness;
    like.contiguous = !desk.settings.flood_everywhere;
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
  if (!click_.ends(pointer)) return;
  // On the worker's thread, since the first ray into an object builds its ray tree.
  auto picked = std::make_shared<std::optional<Picked>>();
  desk.jobs.worker.start(
      "pick", [picked, lens, at = pointer.at](Session& session) { *picked = pick(session.scene(), lens, at); },
      [&desk, picked, pointer, floods = floods_] { take(desk, *picked, pointer, floods); });
}

void PickTool::options(Desk& desk) {
  if (!floods_) {
    ui::hint("Click a node to pick it, drag to turn the view. Shift adds, Ctrl removes.");
    return;
  }
  auto likeness = static_cast<float>(desk.settings.likeness);
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Difference of colour");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(px(140));
  if (ImGui::SliderFloat("##difference", &likeness, 0, 1)) desk.settings.likeness = static_cast<double>(likeness);
  announce::item("Difference");
  ui::flow(px(110));
  ui::toggle("Everywhere", desk.settings.flood_everywhere);
  ui::tip("Everywhere", "", "All triangles of that colour; off, only those that hang together with the clicked one.");
  ui::hint("Click what it shall be like. Shift adds, Ctrl removes, both keep what is in both.");
}

}  // namespace rebake
