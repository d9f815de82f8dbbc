#include "editor/gui/view/viewport.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>

#include "editor/commands/lit.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/support.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/style.h"
#include "editor/gui/view/axes.h"
#include "editor/gui/view/grid.h"
#include "editor/gui/view/legend.h"
#include "editor/gui/view/navigation.h"
#include "editor/gui/window/lost_work.h"
#include "render/image.h"
#include "render/thumbnail.h"

namespace rebake {

namespace {

// Time without a change after which the picture is drawn at full quality.
constexpr auto settle_time = std::chrono::milliseconds(200);
constexpr double upload_ms = 6;  // per frame, while a scene is uploaded

// The scene with the theme's background, unless the settings ask for the scene's own.
Scene on_ground(const Scene& scene, const Desk& desk) {
  Scene result = scene;
  const Rgb ground = theme().viewport;
  if (!desk.settings.scene_background) result.background = Color(ground.r, ground.g, ground.b) / 255;
  return result;
}

bool same_scene(const Scene& a, const Scene& b) {
  return a.roots == b.roots && a.background == b.background && a.light == b.light;
}
bool same_view(const View& a, const View& b) {
  return a.camera == b.camera && a.width == b.width && a.height == b.height && a.samples == b.samples;
}

// Whether two cameras differ at most in their near and far planes.
bool from_one_place(const Camera& a, Camera b) {
  b.near_plane = a.near_plane;
  b.far_plane = a.far_plane;
  return a == b;
}

}  // namespace

Viewport::Viewport(Renderer& renderer, Tools& tools, std::function<std::unique_ptr<gl::Context>()> window_context)
    : renderer_(renderer), tools_(tools), window_context_(std::move(window_context)) {
  report_.device = renderer.device();
}
Viewport::~Viewport() = default;

Scene Viewport::drawn(const Desk& desk) { return on_ground(desk.scene(), desk); }

bool Viewport::key(Desk& desk, const KeyPress& press) { return tool(desk).key(desk, press); }

bool Viewport::cancel(Desk& desk) {
  if (desk.view.flying) {
    desk.view.flying = false;
    return true;
  }
  if (std::exchange(desk.tools.drag_begins, std::nullopt)) {
    desk.tools.kind = desk.tools.before.value_or(desk.tools.kind);
    desk.tools.before.reset();
    return true;
  }
  const bool held = tool(desk).busy();
  tool(desk).cancel(desk);
  return held;
}

bool Viewport::moving() const { return Clock::now() - moved_at_ < settle_time; }

double Viewport::next_frame_in(const Desk& desk) const {
  if (desk.jobs.film && desk.jobs.film->waits()) return 0.1;
  if (arrival_) return 0;
  if (desk.jobs.film || desk.view.flying || (thumbnails_.wants() && !moving() && desk.at_rest())) return 0;
  // A reduced picture is followed by one at full quality.
  if (!moving())
    return made_ && (made_->view.width != made_->shown_width || made_->view.samples != desk.view.samples) ? 0 : -1;
  return std::chrono::duration<double>(settle_time).count();
}

bool Viewport::all_made() const {
  return made_ && ahead_of_ && same_scene(ahead_of_->scene, made_->scene) && ahead_of_->lighting == made_->lighting &&
         ahead_of_->view.samples == made_->view.samples;
}

bool Viewport::wants_ahead() const {
  return made_ && texture_ != 0 && !moving() && made_->guides.inspect == Guides::Inspect::none && !all_made();
}

void Viewport::make_ahead(const Desk& desk) {
  try {
    const View view{made_->view.camera, desk.view.width, desk.view.height, desk.view.samples};
    if (renderer_.make_ahead(made_->scene, view, {}, made_->lighting.get())) return;
  } catch (const std::exception&) {
    // The frame that needs the program reports the error.
  }
  ahead_of_ = made_;
}

void Viewport::fly(Desk& desk) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto held = [&](int key, char letter) {
    return io.KeysDown[key] || io.KeysDown[static_cast<unsigned char>(letter)] ? 1.0 : 0.0;
  };
  const Clock::time_point now = Clock::now();
  const double seconds = std::min(0.2, std::chrono::duration<double>(now - flown_at_).count());
  flown_at_ = now;
  const double speed = desk.focus().isEmpty() ? 1 : desk.focus().diagonal().norm() * (io.KeyShift ? 1.0 : 0.3);
  if (io.WantTextInput || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
  const double right = held(GLFW_KEY_RIGHT, 'D') - held(GLFW_KEY_LEFT, 'A'), up = held('E', 'E') - held('Q', 'Q'),
               forward = held(GLFW_KEY_UP, 'W') - held(GLFW_KEY_DOWN, 'S');
  if (right == 0 && up == 0 && forward == 0) return;
  const bool parallel = desk.view.camera.orthographic();
  desk.view.camera =
      flown(desk.view.camera, right * speed * seconds, up * speed * seconds, parallel ? 0 : forward * speed * seconds);
  // In an orthographic view, moving forward has no visible effect, so it zooms.
  if (parallel) desk.view.camera = zoomed(desk.view.camera, desk.view.camera.target, std::exp(-2 * forward * seconds));
}

void Viewport::navigate(Desk& desk, const Lens& lens, const Pointer& pointer) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool picks = desk.tools.kind == ToolKind::pick;
  if (pointer.inside) {
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Middle)) (io.KeyShift ? panning_ : orbiting_) = true;
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Right) && !pointer.let_go) {
      panning_ = true;
      right_pressed_at_ = pointer.at;
    }
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) &&
        (io.KeyAlt ? !pointer.pressed : picks && !io.KeyShift && !io.KeyCtrl))
      orbiting_ = true;
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && picks && !io.KeyShift && !io.KeyCtrl)
      if (const std::optional<Picked> picked = pick(desk.scene(), lens, pointer.at, false))
        desk.view.camera = centred(desk.view.camera, picked->world);
    if (io.MouseWheel != 0 && desk.view.cut > 0 && io.KeyAlt) {
      const double size = desk.focus().isEmpty() ? 1 : desk.focus().diagonal().norm();
      desk.view.cut = std::max(1e-6 * size, desk.view.cut + 0.02 * size * static_cast<double>(io.MouseWheel));
    } else if (io.MouseWheel != 0) {
      // Zooms to the surface under the pointer, else to the point under the pointer at the target's depth.
      const std::optional<Picked> picked = pick(desk.scene(), lens, pointer.at, false);
      const ViewRay ray = lens.ray(pointer.at);
      const Vec3 at = picked ? picked->world : Vec3(ray.origin + ray.direction * lens.depth(desk.view.camera.target));
      desk.view.camera = zoomed(desk.view.camera, at, std::pow(0.85, static_cast<double>(io.MouseWheel)));
    }
  }
  // A right click without a drag opens the context menu.
  if (panning_ && ImGui::IsMouseReleased(ImGuiMouseButton_Right) &&
      (right_pressed_at_ - pointer.at).norm() < static_cast<double>(px(4)))
    desk.asking.context = true;
  if (!io.MouseDown[0] && !io.MouseDown[2]) orbiting_ = false;
  if (!io.MouseDown[1] && !io.MouseDown[2]) panning_ = false;
  const double dx = static_cast<double>(io.MouseDelta.x), dy = static_cast<double>(io.MouseDelta.y);
  if (dx == 0 && dy == 0) return;
  if (orbiting_)
    desk.view.camera = desk.view.flying ? looked(desk.view.camera, dx, dy, desk.view.height)
                                        : orbited(desk.view.camera, dx, dy, desk.view.height);
  else if (panning_)
    desk.view.camera = panned(desk.view.camera, dx, dy, desk.view.height);
}

// Bounds for the camera's planes: the scene, and for an orthographic camera, which is placed in front of them, also
// preview and guides.
Box Viewport::drawn_bounds(const Desk& desk) const {
  Box box = world_bounds(desk.scene());
  if (!desk.view.camera.orthographic()) return box;
  if (desk.preview) box.extend(world_bounds(desk.shown()));
  for (const Guides::Line& line : guides(desk).lines) box.extend(line.from).extend(line.to);
  return box;
}

Guides Viewport::guides(const Desk& desk) const {
  Guides result;
  result.selection = desk.view.show_selection;
  result.dimmed = desk.selected_out_of_scope();
  result.inspect = desk.view.inspect;
  result.channel = desk.view.channel;
  if (desk.settings.grid) add_grid(desk, result.lines);
  // Picked nodes are outlined while the tool works on whole nodes.
  const bool nodes =
      desk.tools.kind == ToolKind::pick ||
      ((desk.tools.kind == ToolKind::move || desk.tools.kind == ToolKind::turn || desk.tools.kind == ToolKind::scale) &&
       desk.selected_triangles() == 0);
  if (nodes && !desk.active.empty())
    for (const std::optional<NodeRef>& node : desk.scope()) result.outlined.push_back(node->id);
  tools_.at(desk.tools.kind)->add_guides(desk, result);
  return result;
}

// Uploads a part of a new scene; true while it is incomplete and the previous one must be shown. Not used for previews
// of drags, which change little, nor for steps in such quick succession that none of them would be visible.
bool Viewport::arrives(const Desk& desk, const Scene& scene) {
  const bool other = made_ && !desk.preview && made_->scene.roots != scene.roots;
  if (other && arrival_ && arrival_->roots != scene.roots && Clock::now() - arrival_->began < settle_time) {
    arrival_.reset();
    return false;
  }
  const double there = other ? renderer_.arrive(scene, upload_ms) : 1;
  if (there < 1) {
    if (!arrival_ || arrival_->roots != scene.roots)
      arrival_ = Arrival{scene.roots, !from_one_place(made_->view.camera, desk.view.camera), Clock::now()};
    arrival_->there = there;
    return true;
  }
  if (arrival_ && !other) renderer_.forget_arrival();
  arrival_.reset();
  return false;
}

void Viewport::picture(Desk& desk) {
  const bool still = !moving() && !desk.view.flying;
  const double wanted_picture_ms = std::max(10.0, 1000.0 / desk.view.target_rate - rest_ms_);
  View view;
  const Scene scene = on_ground(desk.shown(), desk);
  view.camera = desk.view.camera;
  view.samples = desk.view.samples;
  view.width = desk.view.width;
  view.height = desk.view.height;
  desk.relighter.request(scene, desk.preview.has_value(), scene.light ? desk.deform_nodes() : std::set<NodeId>{});
  const std::shared_ptr<const Lighting> lighting =
      scene.light && !desk.view.as_baked ? desk.relighter.latest() : nullptr;
  Made wanted{scene, lighting, view, guides(desk), each_pass_, desk.view.wipe, desk.view.width, desk.view.height};
  // Whether full quality is cheap: nothing has changed, or only the changed pixels would be drawn.
  const auto stays_full = [&] {
    return made_ && same_view(made_->view, view) &&
           ((same_scene(made_->scene, scene) && made_->lighting == lighting && made_->guides == wanted.guides) ||
            (!desk.view.wipe && renderer_.keeps(scene, view, wanted.guides, lighting.get())));
  };
  double scale = 1;
  const bool quick = !still && full_ms_ > wanted_picture_ms && !stays_full();
  if (quick) {
    view.samples = 1;
    scale = desk.view.moving_share > 0 ? desk.view.moving_share : moving_scale_;
    view.width = std::max(16, static_cast<int>(std::lround(desk.view.width * scale)));
    view.height = std::max(16, static_cast<int>(std::lround(desk.view.height * scale)));
    wanted.view = view;
  }
  if (arrives(desk, scene)) {
    if (arrival_->stays || from_one_place(made_->view.camera, view.camera)) return;
    view.camera = with_depth_for(view.camera, world_bounds(made_->scene));
    wanted.scene = made_->scene;
    wanted.lighting = made_->lighting;
    wanted.guides = made_->guides;
    wanted.view = view;
  }
  if (made_ && same_scene(made_->scene, wanted.scene) && made_->lighting == wanted.lighting &&
      same_view(made_->view, view) && made_->guides == wanted.guides && made_->each_pass == each_pass_ &&
      made_->wipe == desk.view.wipe) {
    if (!quick) keep_picture(desk);
    return;
  }
  // Set before drawing, so that an error is reported only once.
  made_ = wanted;
  texture_ = 0;
  const Renderer::Shown shown =
      renderer_.show(wanted.scene, view, {}, wanted.guides, each_pass_, wanted.lighting.get());
  if (!arrival_) renderer_.forget_arrival();
  const double ms = shown.times.frame_ms;
  if (view.width == desk.view.width && view.samples == desk.view.samples && !shown.kept) full_ms_ = ms;
  // Assumes that the duration is proportional to the number of pixels.
  if (quick) moving_scale_ = std::clamp(scale * std::sqrt(wanted_picture_ms / ms), 0.35, 1.0);
  // Smoothed frame rate of the current movement.
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - drawn_at_).count();
  drawn_at_ = now;
  double rate = report_.pictures_a_second;
  if (!still && since < 0.5) rate = rate > 0 ? 0.8 * rate + 0.2 / since : 1 / since;
  report_ = {shown.times, shown.passes, renderer_.peak_gpu_bytes(), report_.device, scale, view.samples, rate};
  if (!desk.view.wipe) {
    before_.reset();
  } else if (!arrival_) {
    // A second renderer holds the imported scene on the GPU during the comparison.
    if (!before_) before_ = std::make_unique<Renderer>(window_context_());
    Guides before;
    before.inspect = desk.view.inspect;
    before.channel = desk.view.channel;
    if (desk.settings.grid) add_grid(desk, before.lines);
    before_texture_ = before_->show(on_ground(desk.project.imported, desk), view, {}, before, false).texture;
  }
  texture_ = shown.texture;
  drew_ = true;
  if (!quick) keep_picture(desk);
}

// Writes the thumbnail that the recovery dialog shows: after each step, but at most every two seconds.
void Viewport::keep_journal_picture(const Desk& desk) {
  constexpr std::chrono::seconds least_time{2};
  if (desk.now->journal.empty() || desk.scene().roots.empty()) return;
  const bool other = journal_of_ != desk.now->journal;
  if (!other && (journal_step_ == desk.now->steps_done || Clock::now() - journal_at_ < least_time)) return;
  journal_of_ = desk.now->journal;
  journal_step_ = desk.now->steps_done;
  journal_at_ = Clock::now();
  try {
    const std::filesystem::path file = thumbnail_file(desk.now->journal);
    std::filesystem::create_directories(file.parent_path());
    write_png(thumbnail_of(renderer_.shown_image(), Thumbnails::width, Thumbnails::height), file, {});
  } catch (const std::exception&) {
    // The dialog then shows an icon instead.
  }
}

// Writes the thumbnail of the file that was just opened or saved, for the list of recent files. Uses the first picture
// at full quality, even if the view still moves: a fast driver does not draw it again when the view rests.
void Viewport::keep_picture(const Desk& desk) {
  if (desk.view.flying || desk.preview || arrival_ || texture_ == 0) return;
  keep_journal_picture(desk);
  const std::vector<Edit>& done = desk.now->done;
  const bool imported = done.size() == 1 && done.front().is<Import>() && !desk.settings.recent.empty();
  const std::string of = !desk.project.path.empty() ? (desk.project.unsaved() ? "" : desk.project.path.string())
                         : imported                 ? desk.settings.recent.front()
                                                    : "";
  if (of.empty() || (of == kept_of_ && kept_step_ == desk.now->steps_done)) return;
  kept_of_ = of;
  kept_step_ = desk.now->steps_done;
  try {
    thumbnails_.keep(of, desk.settings.recent, renderer_.shown_image());
  } catch (const std::exception&) {
    // Without a writable cache the list has no thumbnails; nothing else depends on them.
  }
}

void Viewport::frame_took(double ms) {
  if (!std::exchange(drew_, false)) return;
  const double rest = std::max(0.0, ms - report_.times.frame_ms);
  rest_ms_ = rest_ms_ > 0 ? 0.7 * rest_ms_ + 0.3 * rest : rest;
}

// Draws the before/after line, which the pointer can drag. True if the pointer drags or hovers it.
bool Viewport::draw_wipe(Desk& desk, ImDrawList& list, const ImVec2& origin, const Pointer& pointer) {
  const double grab = static_cast<double>(px(8));
  const double at = desk.view.wipe_at * desk.view.width;
  const bool hot = pointer.inside && std::abs(pointer.at.x() - at) < grab;
  if (hot && pointer.pressed) wiping_ = true;
  if (!pointer.down) wiping_ = false;
  if (wiping_) desk.view.wipe_at = std::clamp(pointer.at.x() / desk.view.width, 0.02, 0.98);
  const float x = origin.x + static_cast<float>(desk.view.wipe_at * desk.view.width);
  const float bottom = origin.y + static_cast<float>(desk.view.height);
  announce::point("wipe", {x, (origin.y + bottom) / 2});
  list.AddLine({x, origin.y}, {x, bottom}, IM_COL32(0, 0, 0, 200), 4);
  list.AddLine({x, origin.y}, {x, bottom}, hot || wiping_ ? IM_COL32(255, 230, 60, 255) : IM_COL32(255, 255, 255, 255),
               2);
  draw_label(list, {x - px(16) - ImGui::CalcTextSize("Before").x, origin.y + px(10)}, "Before");
  draw_label(list, {x + px(16), origin.y + px(10)}, "After");
  return hot || wiping_;
}

// Writes a requested screenshot, or the next picture of a film.
void Viewport::write_pictures(Desk& desk) {
  const auto written = [&](const Camera& camera, int width, int height, const std::filesystem::path& path) {
    made_.reset();
    const Scene scene = with_only(desk.scene(), desk.jobs.pictured);
    const View view{with_depth_for(camera, world_bounds(scene)), width, height, desk.view.samples};
    const Lighting lighting = desk.view.as_baked ? Lighting{} : lit(desk.scene());
    write_png(renderer_.render(scene, view, {}, &lighting), path, desk.now->sources);
  };
  try {
    if (const auto shot = std::exchange(desk.jobs.screenshot, std::nullopt)) {
      written(desk.view.camera, shot->width, shot->height, shot->path);
      desk.messages.say("Wrote " + shot->path.string());
    }
    if (desk.jobs.film) {
      const std::string said = desk.jobs.film->go_on(
          [&](const Camera& camera, const std::filesystem::path& path) {
            written(camera, desk.jobs.film->width(), desk.jobs.film->height(), path);
          },
          desk.now->sources);
      if (!said.empty()) {
        desk.messages.say(said);
        desk.jobs.film.reset();
      }
    }
  } catch (const std::exception& error) {
    desk.jobs.film.reset();
    desk.messages.fail(error.what());
  }
}

void Viewport::draw(Desk& desk, const std::vector<std::array<double, 2>>& moves) {
  const ImVec2 size = ImGui::GetContentRegionAvail(), origin = ImGui::GetCursorScreenPos();
  desk.view.width = std::max(16, static_cast<int>(size.x));
  desk.view.height = std::max(16, static_cast<int>(size.y));
  if (desk.tools.drag_begins && *desk.tools.drag_begins != desk.tools.kind) {
    // Another tool was chosen before the requested drag could begin.
    desk.tools.drag_begins.reset();
    desk.tools.before.reset();
  }
  if (desk.tools.kind != last_tool_) {
    tools_.at(last_tool_)->leave(desk);
    last_tool_ = desk.tools.kind;
  }
  ImGui::InvisibleButton(
      "viewport", size,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle | ImGuiButtonFlags_MouseButtonRight);
  announce::item("viewport");
  const ImGuiIO& io = ImGui::GetIO();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  Pointer pointer;
  pointer.at = Vec2(static_cast<double>(io.MousePos.x - origin.x), static_cast<double>(io.MousePos.y - origin.y));
  for (const auto& [x, y] : moves)
    pointer.way.emplace_back(x - static_cast<double>(origin.x), y - static_cast<double>(origin.y));
  pointer.inside = ImGui::IsItemHovered();
  pointer.alt = io.KeyAlt;
  pointer.pressed =
      ImGui::IsMouseClicked(ImGuiMouseButton_Left) &&
      (!io.KeyAlt || tool(desk).takes_alt(desk, Lens(desk.view.camera, desk.view.width, desk.view.height), pointer.at));
  pointer.down = io.MouseDown[0];
  pointer.released = ImGui::IsMouseReleased(ImGuiMouseButton_Left);
  pointer.double_clicked = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  // The right button cancels a drag, as Escape does.
  pointer.let_go = tool(desk).busy() && ImGui::IsMouseClicked(ImGuiMouseButton_Right);
  if (pointer.let_go) tool(desk).cancel(desk);
  pointer.shift = io.KeyShift;
  pointer.control = io.KeyCtrl;

  list.PushClipRect(origin, {origin.x + size.x, origin.y + size.y}, true);
  list.ChannelsSplit(2);
  list.ChannelsSetCurrent(1);
  draw_legend(desk, list, origin);
  if (desk.view.marked) {
    const ImVec2 at = on_screen(desk.view.marked->cwiseProduct(Vec2(desk.view.width, desk.view.height)), origin);
    announce::point("largest error", at);
    list.AddCircle(at, px(14), IM_COL32(0, 0, 0, 200), 0, px(5));
    list.AddCircle(at, px(14), IM_COL32(255, 230, 60, 255), 0, px(2.5F));
    draw_label(list, {at.x + px(22), at.y - px(8)}, "largest error");
  }
  const bool on_axes = draw_axes(desk, list, {origin.x + size.x, origin.y}, pointer.inside && !tool(desk).busy());
  if (on_axes || (desk.view.wipe && draw_wipe(desk, list, origin, pointer))) {
    pointer.inside = false;
    pointer.pressed = false;
  }
  try {
    navigate(desk, Lens(desk.view.camera, desk.view.width, desk.view.height), pointer);
  } catch (const std::exception& error) {
    desk.messages.fail(error.what());
  }
  if (desk.view.flying) fly(desk);
  // These planes are also those that edits use to select through this camera.
  desk.view.camera = with_depth_for(desk.view.camera, drawn_bounds(desk));
  if (desk.view.cut > 0)
    desk.view.camera.near_plane =
        std::min(std::max(desk.view.camera.near_plane, desk.view.cut), desk.view.camera.far_plane / 2);
  const Lens lens(desk.view.camera, desk.view.width, desk.view.height);
  try {
    if (!desk.jobs.worker.busy() || !tool(desk).wants_scene() || tool(desk).busy())
      tool(desk).pointer(desk, lens, pointer);
    else if (pointer.pressed && pointer.inside)
      desk.messages.say("Something is still being done: click again when it is, or press Esc to stop it.");
    last_tool_ = desk.tools.kind;  // after a drag that a key began, the previous tool returns without ViewTool::leave()
  } catch (const std::exception& error) {
    desk.messages.fail(error.what());
    tool(desk).cancel(desk);
  }
  // Changes are drawn at reduced quality first, and at full quality after settle_time.
  if (!(desk.view.camera == last_camera_) || (made_ && made_->scene.roots != desk.shown().roots)) {
    last_camera_ = desk.view.camera;
    moved_at_ = Clock::now();
  }
  try {
    write_pictures(desk);
    if (thumbnails_.wants() && !moving() && desk.at_rest() && !tool(desk).busy()) {
      made_.reset();
      thumbnails_.draw_one(renderer_, on_ground(desk.scene(), desk));
    }
    picture(desk);
    tool(desk).draw(desk, lens, pointer, list, origin);
  } catch (const std::exception& error) {
    desk.messages.fail(error.what());
  }
  list.ChannelsSetCurrent(0);
  if (texture_ != 0)
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture_)), origin,
                  {origin.x + size.x, origin.y + size.y}, {0, 1}, {1, 0});
  if (desk.view.wipe && before_) {
    const auto share = static_cast<float>(desk.view.wipe_at);
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(before_texture_)), origin,
                  {origin.x + share * size.x, origin.y + size.y}, {0, 1}, {share, 0});
  }
  list.ChannelsMerge();
  list.PopClipRect();
}

}  // namespace rebake
