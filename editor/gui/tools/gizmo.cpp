#include "editor/gui/tools/gizmo.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "editor/edits/nodes/duplicate.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/support.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

constexpr float handle_pixels = 90, gizmo_grab_pixels = 9;
constexpr ImU32 axis_colors[] = {IM_COL32(235, 70, 70, 255), IM_COL32(100, 200, 60, 255), IM_COL32(70, 130, 245, 255),
                                 IM_COL32(235, 235, 235, 255)};

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double t = along.squaredNorm() > 0 ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
  return (a + t * along - p).norm();
}

// Outline of a handle in viewport pixels: a line along the axis, or for rotation a circle around it.
std::vector<Vec2> outline(ToolKind kind, const Vec3& pivot, const Vec3& axis, double reach,
                          const ViewportProjection& lens, int number) {
  std::vector<Vec2> points;
  const auto add = [&](const Vec3& world) {
    if (const auto pixel = lens.pixel(world)) points.push_back(*pixel);
  };
  if (kind == ToolKind::rotate) {
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    constexpr int corners = 48;
    const double radius = number < 3 ? reach : 1.2 * reach;  // the ring around the view direction is outermost
    for (int k = 0; k <= corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      add(pivot + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  } else {
    add(pivot);
    add(pivot + reach * axis);
  }
  return points;
}

// Corners of a plane's handle in world space: a square between its two axes.
constexpr double square_from = 0.28, square_to = 0.46;  // shares of the handles' length
std::array<Vec3, 4> square(const Vec3& pivot, const Vec3& u, const Vec3& v, double reach) {
  const double a = square_from * reach, b = square_to * reach;
  return {pivot + a * u + a * v, pivot + b * u + a * v, pivot + b * u + b * v, pivot + a * u + b * v};
}

// Minimum |cos| between a plane's normal and the view direction: a plane seen edge-on cannot be dragged in.
constexpr double min_tilt = 0.15;

}  // namespace

std::vector<Vec2> Gizmo::plane_handle(const Target& target, const ViewportProjection& lens, int axis) const {
  if (kind_ != ToolKind::move || std::abs(target.axes.col(axis).dot(target.direction_to_eye)) < min_tilt) return {};
  std::vector<Vec2> corners;
  for (const Vec3& corner : square(target.pivot, target.axes.col((axis + 1) % 3), target.axes.col((axis + 2) % 3),
                                   reach(lens, target.pivot)))
    if (const auto pixel = lens.pixel(corner)) corners.push_back(*pixel);
  if (corners.size() < 4) corners.clear();
  return corners;
}

std::optional<Gizmo::Target> Gizmo::target(const ToolContext& editor, const ViewportProjection& lens) const {
  Target target;
  Box box;
  const std::set<NodeId> selected = editor.nodes_in_scope(true);
  for (const PlacedNode& placed : placed_nodes(editor.scene())) {
    if (!selected.contains(placed.node->id)) continue;
    target.nodes.push_back(placed.node->id);
    box.extend(selection_bounds(placed));
  }
  target.triangles = !target.nodes.empty();
  if (!target.triangles) {
    for (const NodeId id : editor.active_tops()) {
      const auto placed = find_placed(editor.scene(), id);
      if (!placed || placed->locked || !placed->visible) continue;
      target.nodes.push_back(id);
      box.extend(subtree_bounds(editor.scene(), id));
    }
  }
  if (target.nodes.empty()) return std::nullopt;
  const auto first = find_placed(editor.scene(), target.nodes.front());
  const Ground& ground = editor.scene().ground;
  target.foot = box.isEmpty()
                    ? Vec3(first->to_world.translation())
                    : Vec3(box.center() + (lowest_above(ground, box) - ground.above(box.center())) * ground.normal);
  target.pivot = box.isEmpty() ? Vec3(first->to_world.translation()) : Vec3(box.center());
  target.local = orthogonal_factor(first->to_world.linear());
  if (editor.tools.local_axes) target.axes = target.local;
  target.direction_to_eye = lens.direction_to_eye(target.pivot);
  return target;
}

double Gizmo::reach(const ViewportProjection& lens, const Vec3& pivot) {
  return static_cast<double>(px(handle_pixels)) * lens.unit(pivot);
}

int Gizmo::handle_at(const Target& target, const ViewportProjection& lens, const Vec2& at) const {
  const auto middle = lens.pixel(target.pivot);
  if (!middle) return none;
  if (kind_ != ToolKind::rotate && (*middle - at).norm() < static_cast<double>(px(gizmo_grab_pixels))) return all;
  for (int axis = 0; axis < 3; ++axis)
    if (const std::vector<Vec2> corners = plane_handle(target, lens, axis);
        !corners.empty() && inside_polygon(corners, at))
      return plane + axis;
  int found = none;
  double least = static_cast<double>(px(gizmo_grab_pixels));
  for (int axis = 0; axis < (kind_ == ToolKind::rotate ? 4 : 3); ++axis) {
    const std::vector<Vec2> line =
        outline(kind_, target.pivot, target.axis(axis), reach(lens, target.pivot), lens, axis);
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
      if (const double distance = distance_to_segment(at, line[k], line[k + 1]); distance < least) {
        least = distance;
        found = axis;
      }
  }
  return found;
}

double Gizmo::amount(const ViewportProjection& lens, const Pointer& pointer) const {
  const auto middle = lens.pixel(at_.pivot);
  if (!middle) return 0;
  const double fine = pointer.shift ? 0.1 : 1;
  double result = 0;
  if (moves_in_plane()) return 1;
  if (kind_ == ToolKind::rotate) {
    const Vec3 axis = at_.axis(held_);
    const Vec2 a = from_ - *middle, b = now_ - *middle;
    double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    // Screen angles are clockwise, since y points down: negate them for an axis that points at the eye.
    if (axis.dot(lens.direction_to_eye(at_.pivot)) > 0) angle = -angle;
    result = angle * 180 / std::numbers::pi * fine;
    return pointer.control ? std::round(result / 15) * 15 : result;
  }
  if (by_key_ && kind_ == ToolKind::scale) {
    // Ratio of the pointer's distances from the pivot, now and at the start, minus 1.
    result = (now_ - *middle).norm() / std::max((from_ - *middle).norm(), 1.0) - 1;
  } else if (held_ == all) {
    result = kind_ == ToolKind::scale ? (now_.x() - from_.x()) / static_cast<double>(px(handle_pixels)) : 1;
  } else {
    const auto end = lens.pixel(at_.pivot + reach(lens, at_.pivot) * at_.axes.col(held_));
    if (!end) return 0;
    const Vec2 along = *end - *middle;
    const double length = along.norm();
    // An axis along the view direction has no direction on the screen.
    if (length < 1) return 0;
    const double pixels = (now_ - from_).dot(along) / length;
    result = kind_ == ToolKind::scale ? pixels / static_cast<double>(px(handle_pixels))
                                      : pixels / length * reach(lens, at_.pivot);
  }
  result *= fine;
  if (!pointer.control) return result;
  // Snap to a power of ten, the largest that is at most the handles' length.
  const double step = kind_ == ToolKind::scale ? 0.1 : std::pow(10, std::floor(std::log10(reach(lens, at_.pivot))));
  return std::round(result / step) * step;
}

Vec3 Gizmo::motion_in_plane(const ViewportProjection& lens, bool orthographic, const Pointer& pointer) const {
  const int axis = held_ - plane;
  const Vec3 normal = at_.axes.col(axis);
  const auto meets = [&](const Vec2& pixel) -> std::optional<Vec3> {
    const ViewRay ray = lens.ray(pixel);
    const double t = (at_.pivot - ray.origin).dot(normal) / ray.direction.dot(normal);
    if (!std::isfinite(t) || (t <= 0 && !orthographic)) return std::nullopt;
    return Vec3(ray.origin + t * ray.direction);
  };
  const auto from = meets(from_), to = meets(now_);
  // Beyond the plane's horizon the motion stays as it is.
  if (!from || !to) return in_plane_;
  Vec3 along = at_.axes.transpose() * (*to - *from) * (pointer.shift ? 0.1 : 1);
  const double step = std::pow(10, std::floor(std::log10(reach(lens, at_.pivot))));
  if (pointer.control) along = (along / step).array().round().matrix() * step;
  along[axis] = 0;
  return at_.axes * along;
}

bool Gizmo::handles_alt_press(const ToolContext& editor, const ViewportProjection& lens, const Vec2& at) const {
  if (kind_ != ToolKind::move) return false;
  const std::optional<Target> here = target(editor, lens);
  return here && !here->triangles && handle_at(*here, lens, at) != none;
}

std::vector<Edit> Gizmo::edits(const ViewportProjection& lens) const {
  Transform transform;
  transform.selection = at_.triangles;
  transform.pivot = at_.pivot;
  if (kind_ == ToolKind::rotate) {
    transform.rotate = Rotation(Eigen::AngleAxisd(amount_ * std::numbers::pi / 180, at_.axis(held_)));
  } else if (kind_ == ToolKind::scale) {
    if (held_ == all)
      transform.scale.value = Vec3::Constant(1 + amount_);
    else
      transform.scale.value[held_] = 1 + amount_;
    // The axes of a mirrored node are not a rotation. Negated ones are, and scale the same.
    transform.scale_axes = Rotation(Eigen::Quaterniond(at_.axes.determinant() < 0 ? Mat3(-at_.axes) : at_.axes));
  } else if (held_ == all) {
    transform.translate =
        snap_point_ ? Vec3(*snap_point_ - foot_) : Vec3(amount_ * lens.motion(at_.pivot, now_ - from_));
  } else if (moves_in_plane()) {
    transform.translate = in_plane_;
  } else {
    transform.translate = amount_ * at_.axes.col(held_);
  }
  std::vector<Edit> result;
  for (const NodeId id : at_.nodes) {
    if (copies_) {
      Duplicate copy;
      copy.node = NodeRef{id};
      copy.translate = transform.translate;
      result.emplace_back(copy);
      continue;
    }
    transform.node = NodeRef{id};
    result.emplace_back(transform);
  }
  return result;
}

void Gizmo::preview(ToolContext& editor, const std::vector<Edit>& made) {
  if (made.empty())
    editor.drop_preview();
  else
    editor.show_preview(made);
}

std::optional<Vec3> Gizmo::surface(const ToolContext& editor, const ViewportProjection& lens, const Vec2& at) const {
  Scene others = editor.scene();
  for (const NodeId id : at_.nodes) others = with_changed(others, id, [](Node& node) { node.visible = false; });
  if (const std::optional<PickHit> picked = pick(others, lens, at, false)) return picked->world;
  // Otherwise the ground plane.
  const ViewRay ray = lens.ray(at);
  const Ground& ground = editor.scene().ground;
  const double t = -ground.above(ray.origin) / ground.normal.dot(ray.direction);
  if (!std::isfinite(t) || t <= 0) return std::nullopt;
  return Vec3(ray.origin + t * ray.direction);
}

void Gizmo::begin(const Target& target, int handle, const Vec2& at) {
  at_ = target;
  foot_ = target.foot;
  snap_point_.reset();
  copies_ = false;
  in_plane_ = Vec3::Zero();
  held_ = handle;
  from_ = now_ = at;
  amount_ = 0;
  typed_.clear();
}

void Gizmo::end(ToolContext& editor) {
  held_ = none;
  constrained_ = entered_ = false;
  axis_presses_ = 0;
  typed_.clear();
  if (!std::exchange(by_key_, false)) return;
  const std::optional<ToolKind> before = std::exchange(editor.tools.before, std::nullopt);
  if (before && editor.tools.kind == kind_) editor.tools.kind = *before;
}

void Gizmo::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (held_ == none) {
    const bool by_key = std::exchange(editor.tools.pending_drag, std::nullopt).has_value();
    if (!by_key && (!pointer.pressed || !pointer.inside)) return;
    const std::optional<Target> here = target(editor, lens);
    if (!here) {
      by_key_ = by_key;
      end(editor);
      return;
    }
    begin(*here, by_key ? all : handle_at(*here, lens, pointer.at), pointer.at);
    by_key_ = by_key;
    copies_ = pointer.alt && kind_ == ToolKind::move && !at_.triangles;
    return;
  }
  // If the view changes during the drag, the same pointer motion means another amount.
  const bool moved = now_ != pointer.at || std::exchange(constrained_, false) || !(camera_ == editor.view.camera);
  camera_ = editor.view.camera;
  now_ = pointer.at;
  const double before = amount_;
  amount_ = amount(lens, pointer);
  if (moves_in_plane()) in_plane_ = motion_in_plane(lens, editor.view.camera.orthographic(), pointer);
  const bool free = held_ == all && kind_ == ToolKind::move;
  if (free && editor.tools.snap_to_surface && !at_.triangles)
    snap_point_ = surface(editor, lens, now_);
  else
    snap_point_.reset();
  if (typed_.value()) amount_ = *typed_.value() - (kind_ == ToolKind::scale ? 1 : 0);
  const bool nothing = moves_in_plane() ? in_plane_.isZero(0) : amount_ == 0 || (free && now_ == from_);
  const std::vector<Edit> made = nothing ? std::vector<Edit>{} : edits(lens);
  if (moved || amount_ != before) preview(editor, made);
  if (by_key_ ? !pointer.pressed && !std::exchange(entered_, false) : !pointer.released) return;
  end(editor);
  if (nothing)
    editor.drop_preview();
  else
    editor.edits(made);
}

void Gizmo::constrain(int axis, bool across) {
  if (across) {
    // A plane seen edge-on cannot be dragged in.
    if (std::abs(at_.axes.col(axis).dot(at_.direction_to_eye)) < min_tilt) return;
    typed_.clear();
    held_ = plane + axis;
    constrained_ = true;
    return;
  }
  // As in Blender: world axis, then local axis, then unconstrained.
  axis_presses_ = held_ == axis ? (axis_presses_ + 1) % 3 : 1;
  held_ = axis_presses_ == 0 ? all : axis;
  at_.axes = axis_presses_ == 2 ? at_.local : Mat3::Identity();
  constrained_ = true;
}

bool Gizmo::key(ToolContext& /*editor*/, const KeyPress& press) {
  if (held_ == none || press.control || press.alt) return false;
  if (press.key >= GLFW_KEY_X && press.key <= GLFW_KEY_Z) {
    if (!press.repeated) constrain(press.key - GLFW_KEY_X, press.shift && kind_ == ToolKind::move);
    return true;
  }
  if (by_key_ && (press.key == GLFW_KEY_ENTER || press.key == GLFW_KEY_KP_ENTER)) {
    entered_ = true;
    return true;
  }
  // A move in a plane is not a single number.
  if ((held_ == all && kind_ == ToolKind::move) || moves_in_plane()) return false;
  return typed_.key(press);
}

void Gizmo::draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
                 const ImVec2& origin) const {
  const std::optional<Target> here = held_ != none ? std::optional(at_) : target(editor, lens);
  if (!here) return;
  const auto middle = lens.pixel(here->pivot);
  if (!middle) return;
  const int hot = held_ != none ? held_ : pointer.inside ? handle_at(*here, lens, pointer.at) : none;
  const announce::Part part("gizmo");
  for (int axis = 0; axis < (kind_ == ToolKind::rotate ? 4 : 3); ++axis) {
    std::vector<ImVec2> line;
    for (const Vec2& p : outline(kind_, here->pivot, here->axis(axis), reach(lens, here->pivot), lens, axis))
      line.push_back(on_screen(p, origin));
    if (line.size() < 2) continue;
    announce::point(std::string(1, "xyzv"[axis]), line[kind_ == ToolKind::rotate ? line.size() / 8 : line.size() - 1]);
    const ImU32 color = axis == hot ? IM_COL32(255, 230, 60, 255) : axis_colors[axis];
    list.AddPolyline(line.data(), static_cast<int>(line.size()), IM_COL32(0, 0, 0, 120), 0, px(5));
    list.AddPolyline(line.data(), static_cast<int>(line.size()), color, 0, px(3));
    if (kind_ == ToolKind::move) list.AddCircleFilled(line.back(), px(6), color);
    if (kind_ == ToolKind::scale)
      list.AddRectFilled({line.back().x - px(6), line.back().y - px(6)}, {line.back().x + px(6), line.back().y + px(6)},
                         color);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Vec2> corners = plane_handle(*here, lens, axis);
    if (corners.empty()) continue;
    std::array<ImVec2, 4> at;
    for (std::size_t k = 0; k < 4; ++k) at[k] = on_screen(corners[k], origin);
    const ImU32 color = hot == plane + axis ? IM_COL32(255, 230, 60, 255) : axis_colors[axis];
    list.AddConvexPolyFilled(at.data(), 4, (color & ~IM_COL32_A_MASK) | (ImU32{150} << IM_COL32_A_SHIFT));
    list.AddPolyline(at.data(), 4, color, ImDrawFlags_Closed, px(1.5F));
    announce::point(std::string(1, "xyz"[axis]) + " plane", on_screen((corners[0] + corners[2]) / 2, origin));
  }
  announce::point("middle", on_screen(*middle, origin));
  if (kind_ != ToolKind::rotate)
    list.AddCircleFilled(on_screen(*middle, origin), px(6), hot == all ? IM_COL32(255, 230, 60, 255) : axis_colors[3]);
  if (held_ == none) return;
  const char* const names[] = {"X", "Y", "Z", kind_ == ToolKind::scale ? "all" : "view", "YZ", "ZX", "XY"};
  std::string text = kind_ == ToolKind::rotate  ? fmt::format("{} {:.2f}°", names[held_], amount_)
                     : kind_ == ToolKind::scale ? fmt::format("{} × {:.3f}", names[held_], 1 + amount_)
                     : held_ == all             ? std::string(names[held_])
                     : moves_in_plane()         ? fmt::format("{} {:.4g}", names[held_], in_plane_.norm())
                                                : fmt::format("{} {:.4g}", names[held_], amount_);
  if (copies_) text = "copy " + text;
  if (held_ != all && at_.axes != Mat3::Identity()) text = "local " + text;
  if (!typed_.text().empty()) text += "  [" + typed_.text() + "]";
  draw_label(list, on_screen(now_ + Vec2(16, 16), origin), text);
}

void Gizmo::options(ToolContext& editor) {
  ui::toggle("Local axes", editor.tools.local_axes);
  ui::tip("Local axes", command_key("Local axes", editor.settings), "Aligns the handles with the object's local axes.");
  const ViewportProjection lens(editor.view.camera, editor.view.width, editor.view.height);
  if (kind_ == ToolKind::move) {
    ui::flow(px(140));
    ui::toggle("Snap to surface", editor.tools.snap_to_surface);
    ui::tip("Snap to surface", command_key("Snap to surface", editor.settings),
            "Places a node that is dragged by its centre on the surface under the pointer, or on the ground plane.");
  }
  const std::optional<Target> here = target(editor, lens);
  if (!here)
    ui::hint("Pick a node, or select triangles.");
  else
    ui::hint(fmt::format("{}: {}. X, Y, Z constrain to an axis, digits set the amount, Ctrl snaps, Shift is precise{}.",
                         here->triangles ? "Selected triangles" : "Picked nodes",
                         by_key_ ? "move the pointer, then click or press Enter" : "drag a handle",
                         kind_ == ToolKind::move && !here->triangles ? ", Alt drags a copy" : ""));
}

void Gizmo::cancel(ToolContext& editor) {
  end(editor);
  editor.drop_preview();
}

}  // namespace rebake
