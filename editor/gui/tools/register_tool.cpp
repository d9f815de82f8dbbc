#include "editor/gui/tools/register_tool.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "editor/edits/nodes/register.h"
#include "editor/gui/tools/picked_points.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/registration/similarity.h"

namespace rebake {

namespace {

bool contains(const Node& node, NodeId wanted) {
  if (node.id == wanted) return true;
  for (const NodePtr& child : node.children)
    if (contains(*child, wanted)) return true;
  return false;
}

}  // namespace

void RegisterTool::add(ToolContext& editor, const PickHit& hit) {
  const std::vector<NodeId> tops = editor.active_tops();
  if (from_.empty() && tops.size() != 1) {
    editor.messages.say("Pick one node in the outline first: it moves onto the others.");
    return;
  }
  if (from_.empty()) node_ = tops.front();
  const NodePtr node = find(editor.scene(), node_);
  if (!node) {
    cancel(editor);
    return;
  }
  const bool moves = contains(*node, hit.node), wants_moving = from_.size() == onto_.size();
  if (moves != wants_moving) {
    editor.messages.say(moves ? "This point is on the node that moves. Click the same place in the other capture."
                              : fmt::format("Click a point of \"{}\" first.", node->name));
    return;
  }
  (moves ? from_ : onto_).push_back(hit.world);
  roots_ = editor.scene().roots;
}

void RegisterTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (click_.ends(pointer))
    pick_point(editor, lens, pointer.at, "There is no surface at this pixel.",
               [this, &editor](const PickHit& hit) { add(editor, hit); });
}

void RegisterTool::draw(const ToolContext& /*editor*/, const ViewportProjection& lens, const Pointer& /*pointer*/,
                        ImDrawList& list, const ImVec2& origin) const {
  for (std::size_t k = 0; k < onto_.size(); ++k) {
    const auto a = lens.pixel(from_[k]), b = lens.pixel(onto_[k]);
    if (a && b) list.AddLine(on_screen(*a, origin), on_screen(*b, origin), IM_COL32(255, 255, 255, 130), px(1));
  }
  draw_points("register-from", from_, lens, list, origin, IM_COL32(250, 150, 80, 255), true);
  draw_points("register-onto", onto_, lens, list, origin, IM_COL32(110, 190, 255, 255), true);
}

void RegisterTool::remove_last() {
  if (from_.size() > onto_.size())
    from_.pop_back();
  else if (!onto_.empty())
    onto_.pop_back();
}

bool RegisterTool::key(ToolContext& /*editor*/, const KeyPress& press) {
  if (press.key != GLFW_KEY_BACKSPACE || from_.empty()) return false;
  remove_last();
  return true;
}

std::string RegisterTool::fit_words() const {
  if (onto_.size() < 3) return fmt::format("{} of 3 pairs or more. Backspace removes the last point.", onto_.size());
  try {
    const PairFit fit =
        fit_pairs({from_.begin(), from_.begin() + static_cast<std::ptrdiff_t>(onto_.size())}, onto_, scale_);
    std::string words = "residuals";
    for (const double residual : fit.residuals) words += fmt::format(" {:.3g}", residual);
    return words;
  } catch (const Error& why) {
    return why.what();
  }
}

void RegisterTool::options(ToolContext& editor) {
  if (!from_.empty() && editor.at_rest() && editor.scene().roots != roots_) cancel(editor);
  ui::toggle("Scale##scale", scale_);
  ui::tip("Scale", "", "Also changes the node's size. Off: it only moves and rotates.");
  ui::flow(px(80));
  ui::toggle("Refine##refine", refine_);
  ui::tip("Refine", "", "After the pairs, fits the surfaces that both captures have.");
  ui::flow(px(90));
  ImGui::BeginDisabled(onto_.size() < 3 || from_.size() != onto_.size() || !editor.at_rest());
  if (ui::button("Register##register")) {
    Register edit;
    edit.node = {node_};
    edit.points.points = from_;
    edit.onto.points = onto_;
    edit.scale = scale_;
    edit.refine = refine_;
    editor.edits_unchanged(
        {edit}, [roots = roots_](const Scene& scene) { return scene.roots == roots; },
        [this, &editor] { cancel(editor); });
  }
  ImGui::EndDisabled();
  ui::tip("Register", "", "Moves the picked node so that its points fall onto their counterparts.");
  const NodePtr node = from_.empty() ? nullptr : find(editor.scene(), node_);
  if (!node)
    ui::hint("Click a point of the picked node, then the same place in the other capture.");
  else if (from_.size() > onto_.size())
    ui::hint(fmt::format("Click the place of point {} in the other capture.", from_.size()));
  else
    ui::hint(fit_words());
}

void RegisterTool::cancel(ToolContext& /*editor*/) {
  from_.clear();
  onto_.clear();
}

}  // namespace rebake
