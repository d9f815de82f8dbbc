#include "editor/gui/tools/cage_tool.h"

#include <GLFW/glfw3.h>

#include <map>
#include <utility>

#include "editor/edits/deform/cage.h"
#include "editor/edits/deform/deforming.h"
#include "mesh_ops/deform/cage_deformation.h"

namespace rebake {

namespace {

constexpr double cage_grab_pixels = 10;

}  // namespace

/// A cage with everything bound to it, for previews.
struct CageTool::Bound {
  CageDeform edit;  ///< without moves
  Cage cage;
  DeformSet set;
  std::unique_ptr<Coordinates> coordinates;
  std::vector<std::unique_ptr<CageBinding>> bindings;  ///< one a node of the set
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
};

CageTool::CageTool() = default;
CageTool::~CageTool() = default;

void CageTool::make(Desk& desk) {
  const std::optional<DeformTarget> target = desk.deform_target();
  if (!target) {
    desk.messages.error = "there is nothing to put a cage around: open a folder first";
    return;
  }
  CageDeform edit = edit_;
  const double falloff = edit.target.falloff;
  edit.target = *target;
  edit.target.falloff = falloff;
  edit.cage = {};
  if (wraps_)
    edit.cage.wrap = static_cast<double>(coarseness_);
  else
    edit.cage.lattice = {cells_[0], cells_[1], cells_[2]};
  auto made = std::make_shared<std::shared_ptr<const Bound>>();
  desk.jobs.worker.start(
      "cage",
      [edit, made](Session& session) {
        auto bound = std::make_shared<Bound>();
        bound->edit = edit;
        bound->set = deform_set(session.scene(), edit.target);
        bound->cage = cage_of(edit.cage, bound->set, session.progress);
        bound->coordinates = coordinates_of(bound->cage, edit.coordinates, edit.resolution, session.progress);
        for (std::size_t k = 0; k < bound->set.nodes.size(); ++k) {
          std::vector<Vec3> places;
          deformed(*bound->set.nodes[k].node->object, bound->set.nodes[k].to_world, bound->set.flags[k], 0,
                   [&](const std::vector<Vec3>& world) {
                     places = world;
                     return DeformedPoints{world, std::vector<Mat3>(world.size(), Mat3::Identity()), {}};
                   });
          bound->bindings.push_back(
              std::make_unique<CageBinding>(*bound->coordinates, bound->cage, places, session.progress));
        }
        for (const Face& face : bound->cage.faces)
          for (std::size_t k = 0; k < 3; ++k)
            if (face[k] < face[(k + 1) % 3]) bound->edges.emplace_back(face[k], face[(k + 1) % 3]);
        *made = std::move(bound);
      },
      [this, made] {
        bound_ = *made;
        moved_ = bound_->cage.vertices;
        picked_.assign(moved_.size(), 0);
      });
}

void CageTool::apply(Desk& desk) {
  if (!bound_) return;
  // Points that moved alike are one move.
  std::map<std::array<double, 3>, NumberRanges> groups;
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    const Vec3 motion = moved_[v] - bound_->cage.vertices[v];
    if (motion.isZero(0)) continue;
    auto& ranges = groups[{motion.x(), motion.y(), motion.z()}].ranges;
    if (!ranges.empty() && ranges.back().second + 1 == v)
      ranges.back().second = v;
    else
      ranges.emplace_back(v, v);
  }
  if (groups.empty()) return;
  CageDeform edit = bound_->edit;
  edit.target.falloff = edit_.target.falloff;
  for (const auto& [motion, points] : groups) {
    CageMove move;
    move.points = points;
    move.translate = Vec3(motion[0], motion[1], motion[2]);
    edit.moves.push_back(move);
  }
  desk.edit(edit);
}

// False once an edit has changed what the cage was made around: its points would mean other places.
bool CageTool::fits(const Desk& desk) const {
  for (const PlacedNode& placed : bound_->set.nodes) {
    const auto now = find_placed(desk.scene(), placed.node->id);
    if (!now || now->node->object != placed.node->object || now->node->selection != placed.node->selection ||
        now->to_world.matrix() != placed.to_world.matrix())
      return false;
  }
  return true;
}

void CageTool::preview(Desk& desk) {
  Scene scene = desk.scene();
  try {
    for (std::size_t k = 0; k < bound_->set.nodes.size(); ++k) {
      const PlacedNode& placed = bound_->set.nodes[k];
      if (find(scene, placed.node->id) == nullptr) return;
      DeformedObject made = deformed(*placed.node->object, placed.to_world, bound_->set.flags[k], edit_.target.falloff,
                                     [&](const std::vector<Vec3>& world) {
                                       // Rotations follow on release: colours are those of the unbent surface
                                       // meanwhile.
                                       DeformedPoints points{{}, std::vector<Mat3>(world.size(), Mat3::Identity()), {}};
                                       bound_->bindings[k]->positions(moved_, points.points);
                                       return points;
                                     });
      scene = with_changed(scene, placed.node->id, [&](Node& node) { node.object = std::move(made.object); });
    }
    desk.show_preview(std::move(scene));
  } catch (const Error& error) {
    desk.messages.error = error.what();
    desk.preview.reset();
  }
}

int CageTool::point_at(const Lens& lens, const Vec2& at) const {
  int found = -1;
  double least = cage_grab_pixels;
  for (std::size_t v = 0; v < moved_.size(); ++v)
    if (const auto pixel = lens.pixel(moved_[v]); pixel && (*pixel - at).norm() < least) {
      least = (*pixel - at).norm();
      found = static_cast<int>(v);
    }
  return found;
}

void CageTool::pointer(Desk& desk, const Lens& lens, const Pointer& pointer) {
  if (bound_ && !fits(desk)) {
    bound_.reset();
    dragging_ = boxing_ = false;
  }
  if (!bound_) return;
  if (pointer.pressed && pointer.inside) {
    held_ = point_at(lens, pointer.at);
    if (held_ < 0) {
      if (!pointer.shift) std::fill(picked_.begin(), picked_.end(), std::uint8_t{0});
      boxing_ = true;
      from_ = to_ = pointer.at;
      return;
    }
    const auto v = static_cast<std::size_t>(held_);
    if (!pointer.shift && picked_[v] == 0) std::fill(picked_.begin(), picked_.end(), std::uint8_t{0});
    picked_[v] = 1;
    from_ = pointer.at;
    before_ = moved_;
    dragging_ = true;
    return;
  }
  if (boxing_) {
    to_ = pointer.at;
    if (!pointer.released) return;
    boxing_ = false;
    const Vec2 low = from_.cwiseMin(to_), high = from_.cwiseMax(to_);
    for (std::size_t v = 0; v < moved_.size(); ++v)
      if (const auto pixel = lens.pixel(moved_[v]);
          pixel && (pixel->array() >= low.array()).all() && (pixel->array() <= high.array()).all())
        picked_[v] = 1;
  }
  if (!dragging_) return;
  const Vec3 motion = lens.motion(before_[static_cast<std::size_t>(held_)], pointer.at - from_);
  Box box;
  for (const Vec3& p : bound_->cage.vertices) box.extend(p);
  const double soft = static_cast<double>(softness_) * box.diagonal().norm();
  bool changed = false;
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    double share = picked_[v] != 0 ? 1 : 0;
    if (share == 0 && soft > 0)
      for (std::size_t w = 0; w < moved_.size(); ++w)
        if (picked_[w] != 0) {
          const double t = std::max(0.0, 1 - (before_[v] - before_[w]).norm() / soft);
          share = std::max(share, t * t * (3 - 2 * t));
        }
    const Vec3 next = share > 0 ? Vec3(before_[v] + share * motion) : before_[v];
    changed = changed || next != moved_[v];
    moved_[v] = next;
  }
  if (changed) preview(desk);
  if (pointer.released) dragging_ = false;
}

void CageTool::draw(const Desk& /*desk*/, const Lens& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const {
  if (!bound_) return;
  if (boxing_) list.AddRect(on_screen(from_, origin), on_screen(to_, origin), IM_COL32(255, 140, 20, 255));
  const int hot = dragging_ ? held_ : pointer.inside ? point_at(lens, pointer.at) : -1;
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    const auto pixel = lens.pixel(moved_[v]);
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    list.AddCircleFilled(at, 5, IM_COL32(0, 0, 0, 160));
    list.AddCircleFilled(at, 4,
                         static_cast<int>(v) == hot ? IM_COL32(255, 230, 60, 255)
                         : picked_[v] != 0          ? IM_COL32(255, 140, 20, 255)
                                                    : IM_COL32(120, 190, 255, 255));
  }
}

void CageTool::add_guides(const Desk& /*desk*/, std::vector<Guides::Line>& lines) const {
  if (!bound_) return;
  for (const auto& [a, b] : bound_->edges) lines.push_back({moved_[a], moved_[b], Color(0.35, 0.65, 1), 0.9, 0.3});
}

bool CageTool::key(Desk& desk, const KeyPress& press) {
  if (press.key != GLFW_KEY_ENTER || !bound_ || busy()) return false;
  apply(desk);
  return true;
}

void CageTool::options(Desk& desk) {
  ImGui::SetNextItemWidth(90);
  int kind = wraps_ ? 1 : 0;
  if (ImGui::Combo("##kind", &kind, "lattice\0wrap\0")) wraps_ = kind == 1;
  flow(130);
  ImGui::SetNextItemWidth(110);
  if (wraps_)
    ImGui::SliderFloat("coarseness", &coarseness_, 0.02F, 0.5F, "%.2f");
  else
    ImGui::InputInt3("cells", cells_);
  flow(130);
  ImGui::SetNextItemWidth(110);
  int coordinates = static_cast<int>(edit_.coordinates);
  if (ImGui::Combo("##coordinates", &coordinates, "mean value\0Green\0harmonic\0"))
    edit_.coordinates = static_cast<CageCoordinates>(coordinates);
  flow(75);
  if (ImGui::Button("Make cage")) make(desk);
  if (!bound_) {
    flow_text("around the selected triangles, else the picked node");
    return;
  }
  flow(130);
  ImGui::SetNextItemWidth(90);
  ImGui::SliderFloat("soft", &softness_, 0, 1, "%.2f");
  flow(130);
  ImGui::SetNextItemWidth(80);
  auto falloff = static_cast<float>(edit_.target.falloff);
  if (ImGui::InputFloat("falloff", &falloff)) edit_.target.falloff = std::max(0.0, static_cast<double>(falloff));
  flow(50);
  if (ImGui::Button("Reset")) {
    moved_ = bound_->cage.vertices;
    desk.preview.reset();
  }
  flow(50);
  if (ImGui::Button("Apply")) apply(desk);
}

void CageTool::cancel(Desk& desk) {
  if (std::exchange(boxing_, false)) return;
  desk.preview.reset();
  if (std::exchange(dragging_, false)) {
    moved_ = before_;
    if (moved_ != bound_->cage.vertices) preview(desk);
    return;
  }
  bound_.reset();
}

}  // namespace rebake
