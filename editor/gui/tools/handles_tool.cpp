#include "editor/gui/tools/handles_tool.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <Eigen/QR>
#include <array>
#include <nlohmann/json.hpp>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

constexpr float pin_grab_pixels = 11;
// Radius within which a pin moves cage points, in units of the cage's coarseness: large enough to contain some.
constexpr double reach_of_coarseness = 1.3;

// World corners of a triangle, by its index in the object.
std::array<Vec3, 3> corners_of(const PlacedNode& placed, std::size_t triangle) {
  for (const TextureSet& set : placed.node->object->sets) {
    if (triangle < set.soup.triangle_count()) {
      std::array<Vec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = placed.to_world * set.soup.positions()[set.soup.faces()[triangle][k]];
      return corners;
    }
    triangle -= set.soup.triangle_count();
  }
  return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
}

// The point of triangle `b` with the barycentric coordinates that `point` has in triangle `a`.
Vec3 same_point(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, const Vec3& point) {
  if (a == b) return point;
  const Vec3 u = a[1] - a[0], v = a[2] - a[0], normal = u.cross(v), to = point - a[0];
  const double area = normal.squaredNorm();
  if (!(area > 0)) return b[0];
  return b[0] + to.cross(v).dot(normal) / area * (b[1] - b[0]) + u.cross(to).dot(normal) / area * (b[2] - b[0]);
}

}  // namespace

std::optional<HandlesDeform> HandlesTool::edit_for(const Pins& pins) const {
  HandlesDeform edit;
  edit.target = target_;
  edit.cage.wrap = static_cast<double>(coarseness_);
  for (const Pin& pin : pins) {
    CageMove move;
    move.sphere = SphereRegion{pin.at, reach_};
    move.nearest = true;  // a wrap has few points in flat regions
    move.translate = pin.motion();
    (pin.motion().isZero(0) ? edit.fixed : edit.moves).push_back(move);
  }
  if (edit.moves.empty()) return std::nullopt;
  return edit;
}

void HandlesTool::begin(ToolContext& editor) {
  end();
  const std::optional<DeformTarget> target = editor.one_deform_target();
  if (!target) return;
  target_ = *target;
  from_ = editor.scene();
  reach_ = reach_of_coarseness * static_cast<double>(coarseness_) * editor.deform_bounds({target_}).diagonal().norm();
  steps_ = {{}};
}

void HandlesTool::end() {
  from_.reset();
  hidden_ = false;
  pins_.clear();
  steps_.clear();
  at_ = 0;
}

void HandlesTool::add(ToolContext& editor, const ViewportProjection& lens, const Vec2& at, bool holds) {
  if (!shown()) begin(editor);
  if (!from_) return;
  auto picked = std::make_shared<std::optional<PickHit>>();
  auto scene = std::make_shared<Scene>();
  editor.jobs.worker.start(
      "picking the surface",
      [picked, scene, lens, at](Session& session) {
        *scene = session.scene();
        *picked = pick(*scene, lens, at);
      },
      [this, &editor, picked, scene, holds] {
        if (!*picked || !from_) return;
        const auto rest = find_placed(*from_, (*picked)->node), now = find_placed(*scene, (*picked)->node);
        const bool taken =
            rest && now && (!target_.node || target_.node->id == rest->node->id) &&
            (!target_.selection || (rest->node->selection && (*rest->node->selection)[(*picked)->triangle] != 0));
        if (!taken) {
          editor.messages.say(target_.selection
                                  ? "This triangle is not selected. Only selected triangles are deformed."
                                  : "This point is not on the deformed object (" + editor.scope_words() + ").");
          return;
        }
        // The same point of the same triangle before the deformation.
        const Vec3 was =
            same_point(corners_of(*now, (*picked)->triangle), corners_of(*rest, (*picked)->triangle), (*picked)->world);
        pins_.push_back({was, (*picked)->world, holds});
      });
}

// Follows undo, redo and other edits. Pins are shown while the document's last edit is one of their releases, or while
// it has the scene in which they were set.
void HandlesTool::follow(ToolContext& editor) {
  if (!from_ || !editor.at_rest() || busy()) return;
  hidden_ = false;
  if (editor.scene().roots == from_->roots) {
    if (at_ > 0) {
      at_ = 0;
      for (Pin& pin : pins_) pin.moved = pin.at;
    }
    return;
  }
  const HandlesDeform* last = editor.now->done.empty() ? nullptr : editor.now->done.back().as<HandlesDeform>();
  if (last != nullptr)
    for (std::size_t k = 1; k < steps_.size(); ++k)
      if (const auto made = edit_for(steps_[k]); made && to_json(*made) == to_json(*last)) {
        if (at_ != k) pins_ = steps_[at_ = k];
        return;
      }
  hidden_ = true;
}

void HandlesTool::show(ToolContext& editor) {
  std::vector<Edit> list;
  if (const auto wanted = edit_for(pins_)) list.emplace_back(*wanted);
  editor.show_preview(std::move(list), from_);
}

// Records the pins as a step of the document's history: the first release as an edit, each later one as a revision.
void HandlesTool::commit(ToolContext& editor) {
  if (editor.scene().roots != roots_) {
    pins_ = before_;
    editor.drop_preview();
    editor.messages.fail("Another step was applied during the drag; nothing was changed.");
    return;
  }
  steps_.resize(at_ + 1);
  steps_.push_back(pins_);
  const std::optional<HandlesDeform> wanted = edit_for(pins_);
  const auto done = [this, &editor] {
    ++at_;
    roots_ = editor.scene().roots;  // a drag that has begun since goes on
  };
  const auto failed = [this] {
    steps_.resize(at_ + 1);
    if (at_ > 0)
      pins_ = steps_[at_];
    else
      for (Pin& pin : pins_) pin.moved = pin.at;
  };
  if (!wanted) {
    if (std::exchange(at_, 0) > 0) editor.undo(editor.now->revised_steps);  // no pin has moved
  } else if (at_ == 0) {
    editor.edits({*wanted}, done, failed);
  } else {
    editor.revise({*wanted}, done, failed);
  }
}

int HandlesTool::pin_at(const ViewportProjection& lens, const Vec2& at) const {
  if (!shown()) return -1;
  int found = -1;
  double least = static_cast<double>(px(pin_grab_pixels));
  for (std::size_t k = 0; k < pins_.size(); ++k)
    if (const auto pixel = lens.pixel(pins_[k].moved); pixel && (*pixel - at).norm() < least) {
      least = (*pixel - at).norm();
      found = static_cast<int>(k);
    }
  return found;
}

void HandlesTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  follow(editor);
  if (pointer.pressed && pointer.inside) {
    const int pin = pin_at(lens, pointer.at);
    if (pin < 0) {
      add(editor, lens, pointer.at, holds_ != pointer.shift);
      return;
    }
    if (pointer.control) {
      remove_pin(editor, static_cast<std::size_t>(pin));
      return;
    }
    held_ = pin;
    before_ = pins_;
    roots_ = editor.scene().roots;
    pressed_at_ = pointer.at;
    return;
  }
  if (held_ < 0) return;
  const auto k = static_cast<std::size_t>(held_);
  const Vec3 wanted = before_[k].moved + lens.motion(before_[k].moved, pointer.at - pressed_at_);
  if (wanted != pins_[k].moved && (pointer.at != pressed_at_ || pins_[k].moved != before_[k].moved)) {
    pins_[k].moved = wanted;
    pins_[k].holds = false;
    show(editor);
  }
  if (!pointer.released) return;
  held_ = -1;
  if (pins_[k].moved != before_[k].moved)
    commit(editor);
  else
    editor.drop_preview();
}

void HandlesTool::remove_pin(ToolContext& editor, std::size_t pin) {
  pins_.erase(pins_.begin() + static_cast<std::ptrdiff_t>(pin));
  if (at_ == 0) return;  // the document has no edit of the pins yet
  roots_ = editor.scene().roots;
  show(editor);
  commit(editor);
}

void HandlesTool::draw(const ToolContext& /*editor*/, const ViewportProjection& lens, const Pointer& pointer,
                       ImDrawList& list, const ImVec2& origin) const {
  if (!shown()) return;
  const announce::Part part("handle");
  const int hot = held_ >= 0 ? held_ : pointer.inside ? pin_at(lens, pointer.at) : -1;
  for (std::size_t k = 0; k < pins_.size(); ++k) {
    const auto pixel = lens.pixel(pins_[k].moved);
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    announce::point(fmt::format("{}", k), at);
    const ImU32 color = static_cast<int>(k) == hot ? IM_COL32(255, 230, 60, 255)
                        : pins_[k].holds           ? IM_COL32(120, 190, 255, 255)
                                                   : IM_COL32(255, 120, 200, 255);
    if (const auto rest = lens.pixel(pins_[k].at); rest && !pins_[k].motion().isZero(0))
      list.AddLine(on_screen(*rest, origin), at, color, px(1.5F));
    list.AddCircleFilled(at, px(8), IM_COL32(0, 0, 0, 170));
    // Fixed pins are square and dragged ones round, so that they differ not only in colour.
    if (pins_[k].holds)
      list.AddRectFilled({at.x - px(5), at.y - px(5)}, {at.x + px(5), at.y + px(5)}, color);
    else
      list.AddCircleFilled(at, px(6.5F), color);
  }
}

bool HandlesTool::key(ToolContext& editor, const KeyPress& press) {
  if (press.key != GLFW_KEY_BACKSPACE || pins_.empty() || !shown() || busy()) return false;
  if (editor.at_rest()) remove_pin(editor, pins_.size() - 1);
  return true;
}

void HandlesTool::options(ToolContext& editor) {
  int kind = holds_ ? 0 : 1;
  if (ui::choice("kind", kind, {"Fix##fix", "Drag##drag"})) holds_ = kind == 0;
  ui::tip("Handle type", "", "A click sets a fixed handle or one to drag. Shift sets the other type.");
  ui::flow(px(150));
  ImGui::SetNextItemWidth(px(140));
  ImGui::BeginDisabled(shown());
  ImGui::SliderFloat("##coarseness", &coarseness_, 0.03F, 0.2F, "coarseness %.2f");
  ImGui::EndDisabled();
  ui::tip("Coarseness", "",
          "Coarseness of the underlying cage, as a share of the object's size. Fixed once a handle is set.");
  if (shown() && !pins_.empty()) {
    ui::flow(px(60));
    if (ui::button("Clear")) end();
    ui::tip("Clear", "", "Removes all handles. Their deformation stays.");
  }
  ui::hint(
      pins_.empty() || !shown()
          ? fmt::format("Click to set fixed handles, then handles to drag, and drag those ({}).", editor.scope_words())
          : "Drag a handle to deform. Ctrl+click removes it.");
}

void HandlesTool::cancel(ToolContext& editor) {
  if (held_ >= 0) {
    held_ = -1;
    pins_ = before_;
    editor.drop_preview();
    return;
  }
  end();
}

void HandlesTool::leave(ToolContext& editor) {
  cancel(editor);
  cancel(editor);
}

}  // namespace rebake
