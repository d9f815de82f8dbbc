#include <fmt/format.h>
#include <imgui.h>

#include <set>

#include <cmath>

#include "editor/edits/nodes/transform.h"
#include "editor/edits/support.h"
#include "editor/gui/panels/euler.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

// Sets components within rounding error of 0 to 0. `size`: typical magnitude of the values.
Vec3 shown(const Vec3& value, double size) {
  Vec3 result = value;
  for (int k = 0; k < 3; ++k)
    if (std::abs(result[k]) < 1e-12 * size) result[k] = 0;
  return result;
}

std::string rows_of(const DocumentEditor& editor) {
  std::size_t triangles = 0, sets = 0;
  std::set<const BakedObject*> objects;  // copies share them
  SharedTotals shared;
  bool bent = false;
  // Of the picked nodes and those inside them, each once.
  std::set<NodeId> inside(editor.active.begin(), editor.active.end());
  for (const PlacedNode& placed : placed_nodes(editor.scene())) {
    const NodePtr& one = placed.node;
    if (!inside.contains(one->id)) continue;
    for (const NodePtr& child : one->children) inside.insert(child->id);
    if (!one->object) continue;
    triangles += one->object->triangle_count();
    if (objects.insert(one->object.get()).second) sets += one->object->sets.size();
    shared.add(*one->object);
    bent = bent || one->object->any_rotations();
  }
  if (sets == 0) return "";
  return fmt::format("{} in {}, {:.1f} MB{}", counted(triangles, "triangle"), counted(sets, "texture set"),
                     static_cast<double>(shared.memory()) / 1e6,
                     bent ? ". Deformed: view directions rotate with the triangles." : "");
}

}  // namespace

ui::Changed PropertiesPanel::row(const char* name, Vec3& value, const char* format, double step) {
  ImGui::PushID(name);
  ui::label(name);
  const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  const char* const axes[] = {"X", "Y", "Z"};
  ui::Changed result = ui::Changed::nothing;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) ImGui::SameLine();
    const announce::Part part(name);
    const Vec3 before = value;
    const ui::Changed changed = ui::number_field(axes[axis], value[axis], format, step, width);
    ui::tip(fmt::format("{} {}", name, axes[axis]), "",
            "Drag sideways, or click and type a number or an expression such as 90/4.");
    if (changed == ui::Changed::nothing) {
      value[axis] = before[axis];
      continue;
    }
    result = changed;
    if (changed == ui::Changed::failed)
      problem_ = "The text is not a number. Type a number or an expression such as 90/4.";
  }
  ImGui::PopID();
  return result;
}

void PropertiesPanel::draw_one(DocumentEditor& editor, const PlacedNode& placed) {
  const Placement now = placement_of(placed.node->to_parent);
  const double size = std::max(1e-300, subtree_bounds(editor.scene(), placed.node->id).isEmpty()
                                           ? 1.0
                                           : subtree_bounds(editor.scene(), placed.node->id).diagonal().norm());
  if (!dragging_) {
    from_ = placed.node->to_parent;
    position_ = shown(now.position, size);
    angles_ = shown(euler_degrees(now.rotation), 100);
    scale_ = now.scale;
  }
  Place place;
  place.node = NodeRef{placed.node->id};
  const double unit = std::pow(10, std::floor(std::log10(size)) - 2);
  ui::Changed changed = ui::Changed::nothing;
  const auto take = [&](ui::Changed one, const auto& set) {
    if (one == ui::Changed::nothing || one == ui::Changed::failed) return;
    changed = one;
    set();
  };
  take(row("Position", position_, "{:.5g}", unit), [&] { place.position = position_; });
  take(row("Rotation", angles_, "{:.5g}°", 1),
       [&] { place.rotation = Rotation(Eigen::Quaterniond(rotation_of(angles_))); });
  take(row("Scale", scale_, "{:.5g}", 0.01), [&] { place.scale = Scale{scale_}; });
  if (changed == ui::Changed::nothing) return;
  problem_.clear();
  if (changed == ui::Changed::cancelled) {
    dragging_ = false;
    editor.drop_preview();
    return;
  }
  if (place.scale && (scale_.array() == 0).any()) {
    problem_ = "A scale must not be 0.";
    dragging_ = false;
    editor.drop_preview();
    return;
  }
  dragging_ = changed == ui::Changed::dragged;
  if (dragging_)
    editor.show_preview({place});
  else
    editor.edit_unchanged(place, [id = placed.node->id, from = from_](const Scene& scene) {
      const NodePtr node = find(scene, id);
      return node && node->to_parent.matrix() == from.matrix();
    });
}

void PropertiesPanel::draw_several(DocumentEditor& editor) {
  Box box;
  for (const NodeId id : editor.active) box.extend(subtree_bounds(editor.scene(), id));
  if (box.isEmpty()) return;
  if (!dragging_) {
    position_ = Vec3(0, 0, 0);
    angles_ = Vec3(0, 0, 0);
    scale_ = Vec3(1, 1, 1);
  }
  const double unit = std::pow(10, std::floor(std::log10(std::max(1e-300, box.diagonal().norm()))) - 2);
  ui::Changed changed = ui::Changed::nothing;
  for (const ui::Changed one : {row("Move by", position_, "{:.5g}", unit), row("Rotate by", angles_, "{:.5g}°", 1),
                                row("Scale by", scale_, "{:.5g}", 0.01)})
    if (one != ui::Changed::nothing) changed = one;
  if (changed == ui::Changed::cancelled) {
    dragging_ = false;
    editor.drop_preview();
  }
  if (changed != ui::Changed::dragged && changed != ui::Changed::finished) return;
  std::vector<Edit> list;
  for (const NodeId id : editor.active_tops()) {
    Transform transform;
    transform.node = NodeRef{id};
    transform.pivot = box.center();
    transform.translate = position_;
    transform.rotate = Rotation(Eigen::Quaterniond(rotation_of(angles_)));
    transform.scale.value = scale_;
    list.emplace_back(transform);
  }
  problem_.clear();
  dragging_ = changed == ui::Changed::dragged;
  if (dragging_)
    editor.show_preview(list);
  else
    editor.edits_unchanged(list, [roots = editor.scene().roots](const Scene& scene) { return scene.roots == roots; });
}

void PropertiesPanel::draw(DocumentEditor& editor) {
  const announce::Part part("properties");
  if (editor.active.empty()) {
    ui::muted("Pick a node in the outline or in the viewport.");
    return;
  }
  const auto placed = find_placed(editor.scene(), *editor.active.begin());
  if (!placed) return;
  if (of_ != editor.active) dragging_ = false;
  // Clear an error message after the next step.
  if (of_ != editor.active || problem_step_ != editor.now->steps_done) problem_.clear();
  of_ = editor.active;
  problem_step_ = editor.now->steps_done;
  ImGui::TextUnformatted(editor.active.size() == 1 ? placed->node->name.c_str()
                                                   : fmt::format("{} nodes", editor.active.size()).c_str());
  if (placed->locked) {
    ImGui::SameLine();
    ImGui::TextDisabled("locked");
  }
  ImGui::BeginDisabled(placed->locked);
  // A number that is typed or dragged belongs to the nodes that were picked then.
  for (const NodeId id : editor.active) ImGui::PushID(static_cast<int>(id));
  if (editor.active.size() == 1)
    draw_one(editor, *placed);
  else
    draw_several(editor);
  for (std::size_t k = 0; k < editor.active.size(); ++k) ImGui::PopID();
  ImGui::EndDisabled();
  if (!problem_.empty()) ui::wrapped(problem_, theme().danger);
  if (const std::string rows = rows_of(editor); !rows.empty()) ui::muted(rows);
}

}  // namespace rebake
