#include "editor/gui/tools/cage_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "editor/edits/deform/cage.h"
#include "editor/edits/deform/deforming.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"

namespace rebake {

namespace {

constexpr float cage_grab_pixels = 10;
// Limit of points × cage faces up to which a preview includes rotations from the start (about 0.1 s).
constexpr double max_exact = 2e6;

// Per point: index of its mirror image across the centre of their box along `axis`, or −1. Points on the mirror plane
// are their own image.
std::vector<std::int32_t> partners(const std::vector<Vec3>& points, int axis) {
  Box box;
  for (const Vec3& p : points) box.extend(p);
  const double near = 1e-6 * box.diagonal().norm();
  std::vector<std::int32_t> found(points.size(), -1);
  for (std::size_t v = 0; v < points.size(); ++v) {
    Vec3 other = points[v];
    other[axis] = 2 * box.center()[axis] - other[axis];
    for (std::size_t w = 0; w < points.size() && found[v] < 0; ++w)
      if ((points[w] - other).cwiseAbs().maxCoeff() <= near) found[v] = static_cast<std::int32_t>(w);
  }
  return found;
}

}  // namespace

/// A cage and the points bound to it, for previews.
struct CageTool::Bound {
  CageDeform edit;  ///< settings of the cage, without moves
  Scene scene;      ///< scene in which the cage was made
  Cage cage;
  DeformSet set;  ///< deformed triangles
  std::shared_ptr<const Coordinates> coordinates;
  std::vector<std::vector<Vec3>> places;               ///< per node of the set: positions that move, world space
  std::vector<std::unique_ptr<CageBinding>> bindings;  ///< per node of the set
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  ///< vertex pairs, lower index first
  std::array<std::vector<std::int32_t>, 3> partners;  ///< mirror images of vertices along x, y, z, see partners()
};

CageTool::CageTool() = default;
CageTool::~CageTool() = default;

void CageTool::make(ToolContext& editor) {
  const std::optional<DeformTarget> target = editor.one_deform_target();
  if (!target) return;
  CageDeform edit = edit_;
  edit.target = *target;
  edit.cage = {};
  if (wraps_)
    edit.cage.wrap = static_cast<double>(coarseness_);
  else
    edit.cage.lattice = {cells_[0], cells_[1], cells_[2]};
  unbind();
  auto made = std::make_shared<std::shared_ptr<const Bound>>();
  editor.jobs.worker.start(
      "building a cage",
      [edit, made](Session& session) {
        auto bound = std::make_shared<Bound>();
        bound->edit = edit;
        bound->scene = session.scene();
        bound->set = deform_set(session.scene(), edit.target);
        bound->cage = cage_of(edit.cage, bound->set, session.progress);
        bound->coordinates = shared_coordinates(bound->cage, edit.coordinates, edit.resolution, session.progress);
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
        for (int axis = 0; axis < 3; ++axis)
          bound->partners[static_cast<std::size_t>(axis)] = partners(bound->cage.vertices, axis);
        *made = std::move(bound);
      },
      [this, made] {
        bound_ = *made;
        moved_ = bound_->cage.vertices;
        steps_ = {moved_};
        at_ = 0;
        edit_.target.falloff = 0;
        picked_.assign(moved_.size(), 0);
      });
}

CageDeform CageTool::edit_for(const Points& points) const {
  // Points with equal motion share one move.
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

// Records the cage's points as a step of the document's history: the first release as an edit, each later one as a
// revision of the edit before.
void CageTool::commit(ToolContext& editor) {
  if (editor.scene().roots != roots_) {
    moved_ = before_;
    editor.drop_preview();
    editor.messages.fail("Another step was applied during the drag; nothing was changed.");
    return;
  }
  steps_.resize(at_ + 1);
  steps_.push_back(moved_);
  const CageDeform edit = edit_for(moved_);
  const auto done = [this, &editor] {
    ++at_;
    roots_ = editor.scene().roots;  // a drag that has begun since goes on
  };
  const auto failed = [this] {
    // Drop the step that was not made.
    steps_.resize(at_ + 1);
    moved_ = steps_[at_];
  };
  if (edit.moves.empty()) {
    if (std::exchange(at_, 0) > 0) editor.undo(editor.now->revised_steps);  // dragged back to rest
  } else if (at_ == 0) {
    editor.edits({edit}, done, failed);
  } else {
    editor.revise({edit}, done, failed);
  }
}

// Follows undo, redo and other edits. The cage is shown while the document's last edit is one of its releases, or while
// the scene is the one in which it was made.
void CageTool::follow(ToolContext& editor) {
  if (!bound_ || !editor.at_rest()) return;
  hidden_ = false;
  if (editor.scene().roots == bound_->scene.roots) {
    if (at_ > 0) moved_ = steps_[at_ = 0];
    edit_.target.falloff = 0;
    return;
  }
  const CageDeform* last = editor.now->done.empty() ? nullptr : editor.now->done.back().as<CageDeform>();
  if (last != nullptr) {
    // The adjust panel may have changed the falloff of a release.
    const double before = std::exchange(edit_.target.falloff, last->target.falloff);
    // Several steps can have equal points: prefer the one nearest to the current step.
    std::vector<std::size_t> nearest;
    for (std::size_t k = 1; k < steps_.size(); ++k) nearest.push_back(k);
    const auto away = [this](std::size_t k) { return k > at_ ? k - at_ : at_ - k; };
    std::stable_sort(nearest.begin(), nearest.end(), [&](std::size_t a, std::size_t b) { return away(a) < away(b); });
    for (const std::size_t k : nearest)
      if (to_json(edit_for(steps_[k])) == to_json(*last)) {
        if (at_ != k) moved_ = steps_[at_ = k];
        return;
      }
    edit_.target.falloff = before;
  }
  hidden_ = true;
  dragging_ = selecting_region_ = false;
}

void CageTool::unbind() {
  bound_.reset();
  dragging_ = selecting_region_ = hidden_ = false;
}

void CageTool::preview(ToolContext& editor) {
  // The preview computes positions and rotations as the edit does. If that takes long, one with positions only is shown
  // first.
  const auto made = [bound = bound_, points = moved_, falloff = edit_.target.falloff](bool exact) {
    return [bound, points, falloff, exact](const Progress& progress) {
      Scene scene = bound->scene;
      for (std::size_t k = 0; k < bound->set.nodes.size(); ++k) {
        const PlacedNode& placed = bound->set.nodes[k];
        const auto move = [&](const std::vector<Vec3>& places) {
          if (exact) return deform_points(*bound->coordinates, bound->cage, points, places, true, progress);
          DeformedPoints moved{{}, std::vector<Mat3>(places.size(), Mat3::Identity()), {}};
          bound->bindings[k]->positions(points, moved.points);
          return moved;
        };
        DeformedObject object = deformed(*placed.node->object, placed.to_world, bound->set.flags[k], falloff, move);
        scene = with_changed(scene, placed.node->id, [&](Node& node) { node.object = std::move(object.object); });
      }
      return scene;
    };
  };
  std::size_t places = 0;
  for (const std::vector<Vec3>& some : bound_->places) places += some.size();
  const bool at_once = static_cast<double>(places * bound_->cage.faces.size()) <= max_exact;
  std::vector<Edit> list;
  if (CageDeform edit = edit_for(moved_); !edit.moves.empty()) list.emplace_back(std::move(edit));
  editor.show_preview(std::move(list), bound_->scene, made(at_once));
}

std::vector<std::uint8_t> CageTool::in_front(const ViewportProjection& lens) const {
  std::vector<Vec3> normals(moved_.size(), Vec3::Zero());
  for (const Face& face : bound_->cage.faces) {
    const Vec3 normal = (moved_[face[1]] - moved_[face[0]]).cross(moved_[face[2]] - moved_[face[0]]);
    for (const std::uint32_t v : face) normals[v] += normal;
  }
  std::vector<std::uint8_t> front(moved_.size());
  for (std::size_t v = 0; v < moved_.size(); ++v)
    front[v] = normals[v].dot(lens.direction_to_eye(moved_[v])) >= 0 ? 1 : 0;
  return front;
}

// Front-facing points take precedence over back-facing ones.
int CageTool::point_at(const ToolContext& editor, const ViewportProjection& lens, const Vec2& at) const {
  const std::vector<std::uint8_t> front = in_front(lens);
  for (const std::uint8_t side : {1, 0}) {
    int found = -1;
    double least = static_cast<double>(px(cage_grab_pixels));
    for (std::size_t v = 0; v < moved_.size(); ++v)
      if (const auto pixel = lens.pixel(moved_[v]); front[v] == side && pixel && (*pixel - at).norm() < least) {
        least = (*pixel - at).norm();
        found = static_cast<int>(v);
      }
    if (found >= 0 || editor.tools.visible_only()) return found;
  }
  return -1;
}

void CageTool::pick_inside(const ToolContext& editor, const ViewportProjection& lens) {
  const std::vector<std::uint8_t> front = in_front(lens);
  const Vec2 low = from_.cwiseMin(to_), high = from_.cwiseMax(to_);
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    const auto pixel = lens.pixel(moved_[v]);
    if (!pixel || (editor.tools.visible_only() && front[v] == 0)) continue;
    if (region_is_lasso_ ? inside_polygon(line_, *pixel)
                         : (pixel->array() >= low.array()).all() && (pixel->array() <= high.array()).all())
      picked_[v] = 1;
  }
}

void CageTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (!dragging_) follow(editor);
  if (!shown()) return;
  if (pointer.pressed && pointer.inside) {
    held_ = point_at(editor, lens, pointer.at);
    from_ = to_ = pointer.at;
    if (held_ < 0) {
      if (!pointer.shift) std::fill(picked_.begin(), picked_.end(), std::uint8_t{0});
      selecting_region_ = true;
      region_is_lasso_ = pointer.control;
      line_ = {pointer.at};
      return;
    }
    const auto v = static_cast<std::size_t>(held_);
    if (!pointer.shift && picked_[v] == 0) std::fill(picked_.begin(), picked_.end(), std::uint8_t{0});
    picked_[v] = 1;
    before_ = moved_;
    roots_ = editor.scene().roots;
    dragging_ = true;
    return;
  }
  if (selecting_region_) {
    to_ = pointer.at;
    line_.insert(line_.end(), pointer.way.begin(), pointer.way.end());
    if (!pointer.released) return;
    selecting_region_ = false;
    pick_inside(editor, lens);
  }
  if (dragging_) drag(editor, lens, pointer);
}

std::function<Vec3(const Vec3&)> CageTool::motion(const ViewportProjection& lens, const Pointer& pointer) const {
  const Vec3 way = lens.motion(before_[static_cast<std::size_t>(held_)], pointer.at - from_);
  if (grip_ == DragTransform::move) return [way](const Vec3& p) { return Vec3(p + way); };
  Box picked;
  for (std::size_t v = 0; v < before_.size(); ++v)
    if (picked_[v] != 0) picked.extend(before_[v]);
  const Vec3 middle = picked.center();
  const auto pixel = lens.pixel(middle);
  const Vec2 a = from_ - pixel.value_or(from_), b = pointer.at - pixel.value_or(from_);
  if (!(a.norm() > 1)) return [](const Vec3& p) { return p; };  // grabbed at the centre: angle undefined
  if (grip_ == DragTransform::scale)
    return [middle, factor = b.norm() / a.norm()](const Vec3& p) { return Vec3(middle + factor * (p - middle)); };
  // Screen angles are clockwise, since y points down.
  const double angle = -std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  const Mat3 turn =
      Eigen::AngleAxisd(pointer.control ? std::round(angle * 12 / std::numbers::pi) * std::numbers::pi / 12 : angle,
                        lens.direction_to_eye(middle))
          .toRotationMatrix();
  return [middle, turn](const Vec3& p) { return Vec3(middle + turn * (p - middle)); };
}

void CageTool::drag(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  const std::function<Vec3(const Vec3&)> moves = motion(lens, pointer);
  Box box;
  for (const Vec3& p : bound_->cage.vertices) box.extend(p);
  const double soft = static_cast<double>(softness_) * box.diagonal().norm();
  std::vector<Vec3> moved = before_;
  std::vector<double> shares(moved.size());
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    double share = picked_[v] != 0 ? 1 : 0;
    if (share == 0 && soft > 0)
      for (std::size_t w = 0; w < moved_.size(); ++w)
        if (picked_[w] != 0) {
          const double t = std::max(0.0, 1 - (before_[v] - before_[w]).norm() / soft);
          share = std::max(share, t * t * (3 - 2 * t));
        }
    shares[v] = share;
    if (share > 0) moved[v] = before_[v] + share * (moves(before_[v]) - before_[v]);
  }
  if (symmetric_ > 0) {
    // The side with the larger share of the motion is mirrored to the other. Points on the mirror plane stay on it.
    const std::vector<std::int32_t>& partner = bound_->partners[static_cast<std::size_t>(symmetric_ - 1)];
    const std::vector<Vec3> led = moved;
    const int axis = symmetric_ - 1;
    const double middle = box.center()[axis];
    const auto mirrored = [&](Vec3 p) {
      p[axis] = 2 * middle - p[axis];
      return p;
    };
    // Whether a point is on the same side as the dragged one.
    const auto leads = [&](std::size_t v) {
      return (before_[v][axis] > middle) == (before_[static_cast<std::size_t>(held_)][axis] > middle);
    };
    for (std::size_t v = 0; v < moved.size(); ++v) {
      if (partner[v] < 0) continue;
      const auto w = static_cast<std::size_t>(partner[v]);
      if (w == v)
        moved[v] = (led[v] + mirrored(led[v])) / 2;
      else if (shares[w] > shares[v] || (shares[w] == shares[v] && shares[w] > 0 && leads(w)))
        moved[v] = mirrored(led[w]);
    }
  }
  if (moved != moved_) {
    moved_ = std::move(moved);
    preview(editor);
  }
  if (!pointer.released) return;
  dragging_ = false;
  if (moved_ != before_) commit(editor);
}

void CageTool::draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const {
  if (!shown()) return;
  constexpr ImU32 orange = IM_COL32(255, 140, 20, 255);
  if (selecting_region_ && region_is_lasso_) {
    std::vector<ImVec2> line;
    for (const Vec2& p : line_) line.push_back(on_screen(p, origin));
    list.AddPolyline(line.data(), static_cast<int>(line.size()), orange, ImDrawFlags_Closed, px(1));
  } else if (selecting_region_) {
    list.AddRect(on_screen(from_, origin), on_screen(to_, origin), orange);
  }
  const std::vector<std::uint8_t> front = in_front(lens);
  const int hot = dragging_ ? held_ : pointer.inside ? point_at(editor, lens, pointer.at) : -1;
  const announce::Part part("cage");
  for (std::size_t v = 0; v < moved_.size(); ++v) {
    const auto pixel = lens.pixel(moved_[v]);
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    announce::point(fmt::format("{}", v), at);
    const float radius = px(front[v] != 0 ? 4 : 2.5F);
    list.AddCircleFilled(at, radius + px(1), IM_COL32(0, 0, 0, 160));
    list.AddCircleFilled(at, radius,
                         static_cast<int>(v) == hot ? IM_COL32(255, 230, 60, 255)
                         : picked_[v] != 0          ? orange
                         : front[v] != 0            ? IM_COL32(120, 190, 255, 255)
                                                    : IM_COL32(90, 120, 150, 255));
  }
}

void CageTool::add_guides(const ToolContext& /*editor*/, Guides& guides) const {
  if (!shown()) return;
  for (const auto& [a, b] : bound_->edges)
    guides.lines.push_back({moved_[a], moved_[b], Color(0.35, 0.65, 1), 0.9, 0.3});
}

void CageTool::options(ToolContext& editor) {
  int kind = wraps_ ? 1 : 0;
  if (ui::choice("kind", kind, {"Lattice", "Wrap"})) wraps_ = kind == 1;
  ui::flow(px(120));
  ImGui::SetNextItemWidth(px(120));
  if (wraps_)
    ImGui::SliderFloat("##coarseness", &coarseness_, 0.02F, 0.5F, "coarseness %.2f");
  else
    ImGui::InputInt3("##cells", cells_);
  ui::tip(wraps_ ? "Coarseness" : "Cells", "",
          wraps_ ? "Size of the smallest cavity that the cage follows, as a share of the object's size."
                 : "Number of cells along X, Y and Z.");
  for (int& cells : cells_) cells = std::clamp(cells, 1, 32);
  ui::flow(px(120));
  ImGui::SetNextItemWidth(px(120));
  int coordinates = static_cast<int>(edit_.coordinates);
  if (ImGui::Combo("##coordinates", &coordinates, "mean value\0Green\0harmonic\0"))
    edit_.coordinates = static_cast<CageCoordinates>(coordinates);
  ui::tip("Coordinates", "",
          "Mean value: follows the points. Green: preserves shapes, may leave the cage. Harmonic: stays inside the "
          "cage, slower.");
  ui::flow(px(90));
  if (!shown()) {
    if (ui::primary_button("Make cage##make-cage")) make(editor);
    ui::hint(fmt::format("Builds a cage around the selected triangles, or around a picked node ({}).",
                         editor.scope_words()));
    return;
  }
  if (ui::button("Make cage##make-cage")) make(editor);
  ui::tip("Make cage", "", "Replaces this cage. Its deformation stays.");
  ui::flow(px(130));
  ImGui::SetNextItemWidth(px(110));
  ImGui::SliderFloat("##soft", &softness_, 0, 1, "radius %.2f");
  ui::tip("Proportional editing", "", "Radius within which unselected points follow, as a share of the cage's size.");
  ui::flow(px(200));
  int grip = static_cast<int>(grip_);
  if (ui::choice("grip", grip, {"Move##move", "Rotate##rotate", "Scale##scale"}))
    grip_ = static_cast<DragTransform>(grip);
  ui::flow(px(190));
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Symmetry");
  ImGui::SameLine();
  ui::choice("symmetric", symmetric_, {"Off", "X", "Y", "Z"});
  ui::tip("Symmetry", "", "Mirrors the motion to the points on the other side of the cage's centre.");
  ui::flow(px(120));
  ui::toggle("Visible only##visible-only", editor.tools.visible_only());
  ui::tip("Visible only", command_key("Visible only", editor.settings), "Selects only points that face the camera.");
  ui::hint("Drag points to deform. Drag a box, or a lasso with Ctrl, to select.");
}

void CageTool::cancel(ToolContext& editor) {
  if (std::exchange(selecting_region_, false)) return;
  if (std::exchange(dragging_, false)) {
    moved_ = before_;
    editor.drop_preview();
    return;
  }
  unbind();
}

void CageTool::leave(ToolContext& editor) {
  cancel(editor);
  unbind();
}

}  // namespace rebake
