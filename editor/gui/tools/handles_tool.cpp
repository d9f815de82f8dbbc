#include "editor/gui/tools/handles_tool.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

constexpr float pin_grab_pixels = 11;
// A pin takes the cage's points this many times the cage's coarseness around it, so that it takes some.
constexpr double reach_of_coarseness = 1.3;

}  // namespace

// Nothing while no pin is pulled.
std::optional<HandlesDeform> HandlesTool::edit() const {
  HandlesDeform edit;
  edit.target = target_;
  edit.cage.wrap = static_cast<double>(coarseness_);
  for (const Pin& pin : pins_) {
    CageMove move;
    move.sphere = SphereRegion{pin.at, reach_};
    move.translate = pin.motion();
    (pin.motion().isZero(0) ? edit.fixed : edit.moves).push_back(move);
  }
  if (edit.moves.empty()) return std::nullopt;
  return edit;
}

// Pins begin on the scene as it is.
void HandlesTool::begin(Desk& desk) {
  const std::vector<DeformTarget> targets = desk.deform_targets();
  from_.reset();
  pins_.clear();
  committed_.clear();
  if (targets.empty()) return;
  target_ = targets.front();
  from_ = desk.scene();
  reach_ = reach_of_coarseness * static_cast<double>(coarseness_) * desk.deform_bounds({target_}).diagonal().norm();
}

void HandlesTool::add(Desk& desk, const Lens& lens, const Vec2& at, bool holds) {
  if (!from_) begin(desk);
  if (!from_) return;
  auto picked = std::make_shared<std::optional<Picked>>();
  desk.jobs.worker.start(
      "looking for the surface", [picked, lens, at](Session& session) { *picked = pick(session.scene(), lens, at); },
      [this, &desk, picked, holds] {
        if (!*picked || !from_) return;
        const NodePtr node = find(*from_, (*picked)->node);
        const bool taken = node && (!target_.node || target_.node->id == node->id) &&
                           (!target_.selection || (node->selection && (*node->selection)[(*picked)->triangle] != 0));
        if (taken)
          pins_.push_back({(*picked)->world, (*picked)->world, holds});
        else
          desk.messages.say(target_.selection ? "That is not selected: only selected triangles bend."
                                              : "That is not picked: only " + desk.scope_words().substr(3) + " bends.");
      });
}

// What others did to the document ends it: the pins would mean other places.
void HandlesTool::follow(Desk& desk) {
  if (!from_ || desk.jobs.worker.busy() || busy()) return;
  const bool at_start = desk.scene().roots == from_->roots;
  const bool ours =
      !committed_.empty() && !desk.now->done.empty() && to_json(desk.now->done.back()).dump() == committed_;
  if (at_start && !committed_.empty()) {
    // Undone.
    for (Pin& pin : pins_) pin.moved = pin.at;
    committed_.clear();
  } else if (!at_start && !ours) {
    from_.reset();
    pins_.clear();
    committed_.clear();
  }
}

void HandlesTool::show(Desk& desk) {
  const std::optional<HandlesDeform> wanted = edit();
  if (!wanted) {
    desk.drop_preview();
    return;
  }
  desk.previews.request(desk.scene().roots, [from = *from_, wanted = *wanted](const Progress& progress) {
    return rebake::apply(from, Edit(wanted), progress).scene;
  });
}

void HandlesTool::commit(Desk& desk) {
  const std::optional<HandlesDeform> wanted = edit();
  if (!wanted) {
    if (!committed_.empty()) desk.undo();
    committed_.clear();
    return;
  }
  const bool again = !committed_.empty();
  committed_ = to_json(*wanted).dump();
  if (again)
    desk.adjust({*wanted});
  else
    desk.edits({*wanted}, {}, [this] { committed_.clear(); });
}

int HandlesTool::pin_at(const Lens& lens, const Vec2& at) const {
  int found = -1;
  double least = static_cast<double>(px(pin_grab_pixels));
  for (std::size_t k = 0; k < pins_.size(); ++k)
    if (const auto pixel = lens.pixel(pins_[k].moved); pixel && (*pixel - at).norm() < least) {
      least = (*pixel - at).norm();
      found = static_cast<int>(k);
    }
  return found;
}

void HandlesTool::pointer(Desk& desk, const Lens& lens, const Pointer& pointer) {
  follow(desk);
  if (pointer.pressed && pointer.inside) {
    const int pin = pin_at(lens, pointer.at);
    if (pin < 0) {
      add(desk, lens, pointer.at, holds_ != pointer.shift);
      return;
    }
    if (pointer.control) {
      pins_.erase(pins_.begin() + pin);
      show(desk);
      commit(desk);
      return;
    }
    held_ = pin;
    before_ = pins_;
    pressed_at_ = pointer.at;
    return;
  }
  if (held_ < 0) return;
  const auto k = static_cast<std::size_t>(held_);
  const Vec3 wanted = before_[k].moved + lens.motion(before_[k].moved, pointer.at - pressed_at_);
  if (wanted != pins_[k].moved && (pointer.at != pressed_at_ || pins_[k].moved != before_[k].moved)) {
    pins_[k].moved = wanted;
    pins_[k].holds = false;
    show(desk);
  }
  if (!pointer.released) return;
  held_ = -1;
  if (pins_[k].moved != before_[k].moved) commit(desk);
}

void HandlesTool::draw(const Desk& /*desk*/, const Lens& lens, const Pointer& pointer, ImDrawList& list,
                       const ImVec2& origin) const {
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
    // What holds is square, what pulls is round: not by colour alone.
    if (pins_[k].holds)
      list.AddRectFilled({at.x - px(5), at.y - px(5)}, {at.x + px(5), at.y + px(5)}, color);
    else
      list.AddCircleFilled(at, px(6.5F), color);
  }
}

bool HandlesTool::key(Desk& desk, const KeyPress& press) {
  if (press.key != GLFW_KEY_BACKSPACE || pins_.empty() || busy()) return false;
  pins_.pop_back();
  show(desk);
  commit(desk);
  return true;
}

void HandlesTool::options(Desk& desk) {
  int kind = holds_ ? 0 : 1;
  if (ui::choice("kind", kind, {"Hold", "Pull"})) holds_ = kind == 0;
  ui::tip("What a click sets", "", "Held points stay; pulled ones are dragged. Shift sets the other kind.");
  ui::flow(px(150));
  ImGui::SetNextItemWidth(px(140));
  ImGui::BeginDisabled(from_.has_value());
  ImGui::SliderFloat("##coarseness", &coarseness_, 0.03F, 0.2F, "fineness %.2f");
  ImGui::EndDisabled();
  ui::tip("Fineness", "", "Of the cage that is bent along, as a share of the size; before the first point is set.");
  if (!pins_.empty()) {
    ui::flow(px(60));
    if (ui::button("Clear")) {
      from_.reset();
      pins_.clear();
      committed_.clear();
    }
    ui::tip("Clear", "", "Takes the points away; what they did stays.");
  }
  ui::hint(pins_.empty()
               ? fmt::format("Click points to hold, then points to pull, and drag those ({}).", desk.scope_words())
               : "Drag a point; Ctrl+click takes it away.");
}

void HandlesTool::cancel(Desk& desk) {
  if (held_ >= 0) {
    held_ = -1;
    pins_ = before_;
    desk.drop_preview();
    return;
  }
  from_.reset();
  pins_.clear();
  committed_.clear();
}

void HandlesTool::leave(Desk& desk) {
  cancel(desk);
  cancel(desk);
}

}  // namespace rebake
