#include "editor/gui/tools/cage_tool.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "editor/edits/deform/cage.h"
#include "editor/edits/deform/deforming.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/deform/cage_deformation.h"

namespace rebake {

namespace {

constexpr float cage_grab_pixels = 10;
constexpr std::size_t most_exact = 10000;  // points that a preview moves with their gradients: about 0.1 s

}  // namespace

/// A cage with everything bound to it, for previews.
struct CageTool::Bound {
  CageDeform edit;  ///< without moves
  Scene scene;      ///< that the cage was made in
  Cage cage;
  DeformSet set;
  std::unique_ptr<Coordinates> coordinates;
  std::vector<std::vector<Vec3>> places;               ///< that move, of each node of the set
  std::vector<std::unique_ptr<CageBinding>> bindings;  ///< one a node of the set
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
};

CageTool::CageTool() = default;
CageTool::~CageTool() = default;

void CageTool::make(Desk& desk) {
  const std::vector<DeformTarget> targets = desk.deform_targets();
  if (targets.empty()) {
    desk.messages.fail("There is nothing to put a cage around: open a scene first.");
    return;
  }
  CageDeform edit = edit_;
  edit.target = targets.front();
  edit.target.falloff = edit_.target.falloff;
  if (targets.size() > 1) edit.target.node.reset();  // one cage around all that is selected
  edit.cage = {};
  if (wraps_)
    edit.cage.wrap = static_cast<double>(coarseness_);
  else
    edit.cage.lattice = {cells_[0], cells_[1], cells_[2]};
  unbind(desk);
  auto made = std::make_shared<std::shared_ptr<const Bound>>();
  desk.jobs.worker.start(
      "making a cage",
      [edit, made](Session& session) {
        auto bound = std::make_shared<Bound>();
        bound->edit = edit;
        bound->scene = session.scene();
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
          bound->places.push_back(std::move(places));
        }
        for (const Face& face : bound->cage.faces)
          for (std::size_t k = 0; k < 3; ++k)
            if (face[k] < face[(k + 1) % 3]) bound->edges.emplace_back(face[k], face[(k + 1) % 3]);
        *made = std::move(bound);
      },
      [this, &desk, made] {
        bound_ = *made;
        moved_ = bound_->cage.vertices;
        steps_ = {moved_};
        at_ = 0;
        picked_.assign(moved_.size(), 0);
        desk.tools.own_step = [this, &desk](int direction) { return step(desk, direction); };
      });
}

CageDeform CageTool::edit_for(const Points& points) const {
  // Points that moved alike are one move.
  std::map<std::array<double, 3>, NumberRanges> groups;
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Vec3 motion = points[v] - bound_->cage.vertices[v];
    if (motion.isZero(0)) continue;
    auto& ranges = groups[{motion.x(), motion.y(), motion.z()}].ranges;
    if (!ranges.empty() && ranges.back().second + 1 == v)
      ranges.back().second = v;
    else
      ranges.emplace_back(v, v);
  }
  CageDeform edit = bound_->edit;
  edit.target.falloff = edit_.target.falloff;
  for (const auto& [motion, numbers] : groups) {
    CageMove move;
    move.points = numbers;
    move.translate = Vec3(motion[0], motion[1], motion[2]);
    edit.moves.push_back(move);
  }
  return edit;
}

// Makes the document hold the cage with these points, which are the tool's step of that number.
void CageTool::commit(Desk& desk, const Points& points, std::size_t step) {
  const CageDeform edit = edit_for(points);
  const auto done = [this, step] { at_ = step; };
  const auto failed = [this] {
    // What was not done is not there to be undone.
    steps_.resize(at_ + 1);
    moved_ = steps_[at_];
  };
  if (edit.moves.empty()) {
    if (at_ > 0) desk.undo();
    at_ = step;
  } else if (at_ == 0) {
    desk.edits({edit}, done, failed);
  } else {
    desk.adjust({edit}, done, failed);
  }
}

bool CageTool::step(Desk& desk, int direction) {
  if (!bound_ || busy() || !desk.at_rest()) return bound_ != nullptr;
  if (direction < 0 && at_ == 0) return false;
  if (direction > 0 && at_ + 1 >= steps_.size()) return false;
  const std::size_t next = direction < 0 ? at_ - 1 : at_ + 1;
  moved_ = steps_[next];
  preview(desk);
  commit(desk, moved_, next);
  return true;
}

// What others did to the document: the cage is there as long as the document holds its scene, or its edit last.
void CageTool::follow(Desk& desk) {
  if (!bound_ || !desk.at_rest()) return;
  if (desk.scene().roots == bound_->scene.roots) {
    if (at_ > 0) moved_ = steps_[at_ = 0];
    return;
  }
  const CageDeform* last = desk.now->done.empty() ? nullptr : desk.now->done.back().as<CageDeform>();
  if (last != nullptr)
    // Its border may have been adjusted since.
    edit_.target.falloff = last->target.falloff;
  if (last != nullptr)
    for (std::size_t k = 1; k < steps_.size(); ++k)
      if (to_json(edit_for(steps_[k])) == to_json(*last)) {
        if (at_ != k) moved_ = steps_[at_ = k];
        return;
      }
  unbind(desk);
}

void CageTool::unbind(Desk& desk) {
  bound_.reset();
  dragging_ = boxing_ = false;
  desk.tools.own_step = nullptr;
}

void CageTool::preview(Desk& desk) {
  desk.previews.request(
      desk.scene().roots, [bound = bound_, points = moved_, falloff = edit_.target.falloff](const Progress& progress) {
        Scene scene = bound->scene;
        for (std::size_t k = 0; k < bound->set.nodes.size(); ++k) {
          const PlacedNode& placed = bound->set.nodes[k];
          const auto move = [&](const std::vector<Vec3>& places) {
            // As the edit does it, colours turned too, where that is quick.
            if (places.size() <= most_exact)
              return deform_points(*bound->coordinates, bound->cage, points, places, true, progress);
            DeformedPoints made{{}, std::vector<Mat3>(places.size(), Mat3::Identity()), {}};
            bound->bindings[k]->positions(points, made.points);
            return made;
          };
          DeformedObject made = deformed(*placed.node->object, placed.to_world, bound->set.flags[k], falloff, move);
          scene = with_changed(scene, placed.node->id, [&](Node& node) { node.object = std::move(made.object); });
        }
        return scene;
      });
}

int CageTool::point_at(const Lens& lens, const Vec2& at) const {
  int found = -1;
  double least = static_cast<double>(px(cage_grab_pixels));
  for (std::size_t v = 0; v < moved_.size(); ++v)
    if (const auto pixel = lens.pixel(moved_[v]); pixel && (*pixel - at).norm() < least) {
      least = (*pixel - at).norm();
      found = static_cast<int>(v);
    }
  return found;
}

void CageTool::pointer(Desk& desk, const Lens& lens, const Pointer& pointer) {
  if (!dragging_) follow(desk);
  if (!bound_) return;
  if (pointer.pressed && pointer.inside) {
    held_ = point_at(lens, pointer.at);
    from_ = to_ = pointer.at;
    if (held_ < 0) {
      if (!pointer.shift) std::fill(picked_.begin(), picked_.end(), std::uint8_t{0});
      boxing_ = true;
      return;
    }
    const auto v = static_cast<std::size_t>(held_);
    if (!pointer.shift && picked_[v] == 0) std::fill(picked_.begin(), picked_.end(), std::uint8_t{0});
    picked_[v] = 1;
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
  if (dragging_) drag(desk, lens, pointer);
}

void CageTool::drag(Desk& desk, const Lens& lens, const Pointer& pointer) {
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
  if (!pointer.released) return;
  dragging_ = false;
  if (moved_ == before_) return;
  steps_.resize(at_ + 1);
  steps_.push_back(moved_);
  commit(desk, moved_, at_ + 1);
}

void CageTool::draw(const Desk& /*desk*/, const Lens& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const {
  if (!bound_) return;
  if (boxing_) list.AddRect(on_screen(from_, origin), on_screen(to_, origin), IM_COL32(255, 140, 20, 255));
  const int hot = dragging_ ? held_ : pointer.inside ? point_at(lens, pointer.at) : -1;
  const announce::Part part("cage");
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    const auto pixel = lens.pixel(moved_[v]);
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    announce::point(fmt::format("{}", v), at);
    list.AddCircleFilled(at, px(5), IM_COL32(0, 0, 0, 160));
    list.AddCircleFilled(at, px(4),
                         static_cast<int>(v) == hot ? IM_COL32(255, 230, 60, 255)
                         : picked_[v] != 0          ? IM_COL32(255, 140, 20, 255)
                                                    : IM_COL32(120, 190, 255, 255));
  }
}

void CageTool::add_guides(const Desk& /*desk*/, std::vector<Guides::Line>& lines) const {
  if (!bound_) return;
  for (const auto& [a, b] : bound_->edges) lines.push_back({moved_[a], moved_[b], Color(0.35, 0.65, 1), 0.9, 0.3});
}

void CageTool::options(Desk& desk) {
  int kind = wraps_ ? 1 : 0;
  if (ui::choice("kind", kind, {"Lattice", "Wrap"})) wraps_ = kind == 1;
  ui::flow(px(120));
  ImGui::SetNextItemWidth(px(120));
  if (wraps_)
    ImGui::SliderFloat("##coarseness", &coarseness_, 0.02F, 0.5F, "coarseness %.2f");
  else
    ImGui::InputInt3("##cells", cells_);
  ui::tip(wraps_ ? "Coarseness" : "Cells", "",
          wraps_ ? "The smallest hollow that the cage enters, of its size." : "Along X, Y and Z.");
  for (int& cells : cells_) cells = std::clamp(cells, 1, 32);
  ui::flow(px(120));
  ImGui::SetNextItemWidth(px(120));
  int coordinates = static_cast<int>(edit_.coordinates);
  if (ImGui::Combo("##coordinates", &coordinates, "mean value\0Green\0harmonic\0"))
    edit_.coordinates = static_cast<CageCoordinates>(coordinates);
  ui::tip("Coordinates", "",
          "Mean value: follows the points. Green: keeps shapes, bulges beyond the cage. Harmonic: stays inside the "
          "cage, slower.");
  ui::flow(px(90));
  if (!bound_) {
    if (ui::primary_button("Make cage")) make(desk);
    ui::hint(fmt::format("Around the selected triangles, else a picked node ({}).", desk.scope_words()));
    return;
  }
  if (ui::button("Make cage")) make(desk);
  ui::tip("Make cage", "", "Another one; what this one did stays.");
  ui::flow(px(130));
  ImGui::SetNextItemWidth(px(110));
  ImGui::SliderFloat("##soft", &softness_, 0, 1, "soft %.2f");
  ui::tip("Soft", "", "How far unpicked points follow, of the cage's size.");
  ui::hint("Drag points; a box picks several. Undo takes releases back one by one.");
}

void CageTool::cancel(Desk& desk) {
  if (std::exchange(boxing_, false)) return;
  if (std::exchange(dragging_, false)) {
    moved_ = before_;
    desk.drop_preview();
    return;
  }
  unbind(desk);
}

void CageTool::leave(Desk& desk) {
  cancel(desk);
  unbind(desk);
}

}  // namespace rebake
