#include "editor/gui/tools/pick_tool.h"

#include <memory>
#include <set>

#include "editor/edits/select/select.h"
#include "editor/edits/select/select_like.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

// As with the other tools, replacing and intersecting leave nothing selected in the other nodes of the scope.
std::vector<Edit> flood(const Scene& scene, const SelectLike& like, const std::set<NodeId>& active) {
  std::vector<Edit> edits;
  if (like.mode == SelectMode::set || like.mode == SelectMode::intersect)
    for (const PlacedNode& placed : placed_nodes(scene)) {
      const bool selected = placed.node->selection && count(*placed.node->selection) > 0;
      if (placed.node->id == like.node->id || !selected || !DocumentEditor::in_scope_of(active, scene, placed))
        continue;
      Select none;
      none.node = NodeRef{placed.node->id};
      none.none = true;
      edits.emplace_back(none);
    }
  edits.emplace_back(like);
  return edits;
}

void take(ToolContext& editor, const std::optional<PickHit>& picked, const Pointer& pointer, bool floods) {
  if (floods) {
    if (!picked) return;
    if (!editor.nodes_in_scope().contains(picked->node)) {
      const auto placed = find_placed(editor.scene(), picked->node);
      editor.messages.say(placed && placed->locked ? "This node is locked."
                                                   : "This node is not picked. Tools work only on picked nodes.");
      return;
    }
    SelectLike like;
    like.node = NodeRef{picked->node};
    like.point = picked->world;
    like.color = editor.settings.likeness;
    like.contiguous = !editor.settings.flood_everywhere;
    like.mode = select_mode(pointer);
    // From the scene that it applies to, which an earlier click may have changed.
    editor.edits_from(SelectLike::op,
                      [like, active = editor.active](const Scene& scene) { return flood(scene, like, active); });
    return;
  }
  if (!pointer.shift && !pointer.control) editor.active.clear();
  if (!picked || !find(editor.scene(), picked->node)) return;  // it may be gone by now
  if (pointer.control)
    editor.active.erase(picked->node);
  else
    editor.active.insert(picked->node);
}

}  // namespace

void PickTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (!click_.ends(pointer)) return;
  // On the worker's thread, since the first ray into an object builds its ray tree.
  auto picked = std::make_shared<std::optional<PickHit>>();
  editor.jobs.worker.start_change(
      "pick", [picked, lens, at = pointer.at](Session& session) { *picked = pick(session.scene(), lens, at); },
      [&editor, picked, pointer, floods = floods_, before = editor.active, taken = taken_] {
        // Nodes picked in the meantime are the newer wish, unless an earlier click picked them.
        if (editor.active != before && editor.active != *taken) return;
        take(editor, *picked, pointer, floods);
        *taken = editor.active;
      });
}

void PickTool::options(ToolContext& editor) {
  if (!floods_) {
    ui::hint("Click a node to pick it, drag to orbit. Shift adds, Ctrl removes.");
    return;
  }
  auto likeness = static_cast<float>(editor.settings.likeness);
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Colour tolerance");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(px(140));
  if (ImGui::SliderFloat("##difference", &likeness, 0, 1)) editor.settings.likeness = static_cast<double>(likeness);
  announce::item("Difference");
  ui::flow(px(110));
  ui::toggle("Everywhere##everywhere", editor.settings.flood_everywhere);
  ui::tip("Everywhere", "", "Selects all triangles of a similar colour. Off: only those connected to the clicked one.");
  ui::hint("Click a triangle to select triangles of similar colour. Shift adds, Ctrl removes, both intersect.");
}

}  // namespace rebake
