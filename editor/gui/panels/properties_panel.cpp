#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>

#include "editor/edits/nodes/transform.h"
#include "editor/edits/support.h"
#include "editor/gui/panels/euler.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/tools/expression.h"

namespace rebake {

// A field that takes an expression; true when Enter, or leaving it, gave a new value.
bool PropertiesPanel::number(const char* label, double& value, const char* format) {
  const bool open = editing_ == label;
  std::string text = open ? text_ : fmt::format(fmt::runtime(format), value);
  ImGui::SetNextItemWidth(76);
  ImGui::InputText(label, &text, ImGuiInputTextFlags_AutoSelectAll);
  if (ImGui::IsItemActive()) {
    editing_ = label;
    text_ = text;
    return false;
  }
  if (!open) return false;
  editing_.clear();
  const std::optional<double> read = evaluated(text);
  const bool typed = ImGui::IsItemDeactivatedAfterEdit();
  if (typed && !read) problem_ = "\"" + text + "\" is no number";
  if (!typed || !read || *read == value) return false;
  problem_.clear();
  value = *read;
  return true;
}

void PropertiesPanel::draw(Desk& desk) {
  if (desk.active.empty()) {
    ImGui::TextWrapped("Pick a node in the outline or the picture.");
    return;
  }
  const auto placed = find_placed(desk.scene(), *desk.active.begin());
  if (!placed) return;
  const Node& node = *placed->node;
  ImGui::TextUnformatted(desk.active.size() == 1 ? node.name.c_str()
                                                 : fmt::format("{} nodes", desk.active.size()).c_str());
  if (placed->locked) ImGui::TextDisabled("locked");
  Box box;
  for (const NodeId id : desk.active) box.extend(subtree_bounds(desk.scene(), id));
  const Vec3 center = box.isEmpty() ? Vec3(placed->to_world.translation()) : Vec3(box.center());
  std::vector<Edit> list;
  const auto transform_all = [&](const auto& change) {
    for (const NodeId id : desk.active_tops()) {
      Transform transform;
      transform.node = NodeRef{id};
      transform.pivot = center;
      change(transform);
      list.emplace_back(transform);
    }
  };
  const char* const axes[] = {"X", "Y", "Z"};
  ImGui::TextDisabled("centre, world");
  for (int axis = 0; axis < 3; ++axis) {
    // What is nothing beside the object is shown as nothing.
    double value = !box.isEmpty() && std::abs(center[axis]) < 1e-12 * box.diagonal().norm() ? 0 : center[axis];
    const double shown = value;
    if (number(fmt::format("{}##centre", axes[axis]).c_str(), value, "{:.5g}"))
      transform_all([&](Transform& transform) { transform.translate[axis] = value - shown; });
    if (axis < 2) ImGui::SameLine();
  }
  // One node shows how it stands; several are turned from where they are. A mirrored one has no angles.
  const Mat3 linear = placed->to_world.linear();
  const bool stands = desk.active.size() == 1 && linear.determinant() > 0;
  const Vec3 angles = stands ? euler_degrees(orthogonal_factor(linear)) : Vec3(0, 0, 0);
  ImGui::TextDisabled(stands ? "turned, degrees" : "turn by, degrees");
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 wanted = angles;
    // Rounding is no angle.
    wanted[axis] = std::abs(angles[axis]) < 1e-10 ? 0 : angles[axis];
    if (number(fmt::format("{}##turn", axes[axis]).c_str(), wanted[axis], "{:.5g}"))
      transform_all([&](Transform& transform) {
        transform.rotate = Rotation(Eigen::Quaterniond(Mat3(rotation_of(wanted) * rotation_of(angles).transpose())));
      });
    if (axis < 2) ImGui::SameLine();
  }
  ImGui::TextDisabled("size of the box, world");
  for (int axis = 0; axis < 3; ++axis) {
    const double size = box.isEmpty() ? 0 : box.sizes()[axis];
    double value = size;
    const bool changed = number(fmt::format("{}##size", axes[axis]).c_str(), value, "{:.5g}");
    if (changed && !(value > 0)) problem_ = "a size must be above 0";
    if (changed && value > 0 && size > 0)
      transform_all([&](Transform& transform) { transform.scale.value[axis] = value / size; });
    if (axis < 2) ImGui::SameLine();
  }
  double factor = 1;
  const bool sized = number("all sizes", factor, "x {:.5g}");
  if (sized && !(factor > 0)) problem_ = "a factor must be above 0";
  if (sized && factor > 0) transform_all([&](Transform& transform) { transform.scale.value = Vec3::Constant(factor); });
  if (!list.empty()) desk.edits(list);
  if (!problem_.empty()) ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s", problem_.c_str());
  std::size_t triangles = 0, sets = 0;
  std::uint64_t bytes = 0;
  bool bent = false;
  for (const NodeId id : desk.active) {
    const NodePtr one = find(desk.scene(), id);
    if (!one || !one->object) continue;
    triangles += one->object->triangle_count();
    sets += one->object->sets.size();
    bytes += one->object->memory();
    bent = bent || one->object->any_rotations();
  }
  if (sets == 0) return;
  ImGui::Separator();
  ImGui::Text("%zu triangles in %zu texture sets", triangles, sets);
  ImGui::Text("%.1f MB", static_cast<double>(bytes) / 1e6);
  if (bent) ImGui::TextWrapped("bent: view directions turn with its triangles");
}

}  // namespace rebake
