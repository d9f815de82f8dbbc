#include "editor/gui/app/viewport.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>

#include "editor/actions/lit.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/support.h"
#include "editor/gui/app/legend.h"
#include "editor/gui/state/navigation.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/style.h"
#include "editor/gui/view/axes.h"
#include "editor/gui/view/grid.h"
#include "render/image.h"

namespace rebake {

namespace {

// Time without a change after which the picture is drawn at full quality.
constexpr auto settle_time = std::chrono::milliseconds(200);
constexpr double upload_ms = 6;  // per frame, while a scene is uploaded

// The scene with the theme's background, unless the settings ask for the scene's own.
Scene with_viewport_background(const Scene& scene, const EditorContext& editor) {
  Scene result = scene;
  const Rgb ground = theme().viewport;
  if (!editor.settings.scene_background) result.background = Color(ground.r, ground.g, ground.b) / 255;
  return result;
}

bool same_scene(const Scene& a, const Scene& b) {
  return a.roots == b.roots && a.background == b.background && a.light == b.light;
}
bool same_view(const View& a, const View& b) {
  return a.camera == b.camera && a.width == b.width && a.height == b.height && a.samples == b.samples;
}

// Whether two cameras differ at most in their near and far planes.
bool same_pose(const Camera& a, Camera b) {
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

Scene Viewport::drawn(const EditorContext& editor) { return with_viewport_background(editor.scene(), editor); }

bool Viewport::key(EditorContext& editor, const KeyPress& press) { return tool(editor).key(editor, press); }

bool Viewport::cancel(EditorContext& editor) {
  if (editor.view.flying) {
    editor.view.flying = false;
    return true;
  }
  if (std::exchange(editor.tools.pending_drag, std::nullopt)) {
    editor.tools.kind = editor.tools.before.value_or(editor.tools.kind);
    editor.tools.before.reset();
    return true;
  }
  const bool held = tool(editor).busy();
  tool(editor).cancel(editor);
  return held;
}

bool Viewport::moving() const { return Clock::now() - moved_at_ < settle_time; }

double Viewport::next_frame_in(const EditorContext& editor) const {
  if (editor.jobs.film && editor.jobs.film->waits()) return 0.1;
  if (arrival_) return 0;
  if (editor.jobs.film || editor.view.flying || (thumbnails().wants() && !moving() && editor.at_rest())) return 0;
  // A reduced picture is followed by one at full quality.
  if (!moving())
    return made_ && (made_->view.width != made_->shown_width || made_->view.samples != editor.view.samples) ? 0 : -1;
  return std::chrono::duration<double>(settle_time).count();
}

bool Viewport::all_made() const {
  return made_ && compiled_for_ && same_scene(compiled_for_->scene, made_->scene) &&
         compiled_for_->lighting == made_->lighting && compiled_for_->view.samples == made_->view.samples;
}

bool Viewport::may_compile_ahead() const {
  return made_ && texture_ != 0 && !moving() && made_->guides.inspect == Guides::Inspect::none && !all_made();
}

void Viewport::compile_next_program(const EditorContext& editor) {
  try {
    const View view{made_->view.camera, editor.view.width, editor.view.height, editor.view.samples};
    if (renderer_.compile_next_program(made_->scene, view, {}, made_->lighting.get())) return;
  } catch (const std::exception&) {
    // The frame that needs the program reports the error.
  }
  compiled_for_ = made_;
}

void Viewport::fly(EditorContext& editor) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto held = [&](int key, char letter) {
    return io.KeysDown[key] || io.KeysDown[static_cast<unsigned char>(letter)] ? 1.0 : 0.0;
  };
  const Clock::time_point now = Clock::now();
  const double seconds = std::min(0.2, std::chrono::duration<double>(now - flown_at_).count());
  flown_at_ = now;
  const double speed = editor.focus().isEmpty() ? 1 : editor.focus().diagonal().norm() * (io.KeyShift ? 1.0 : 0.3);
  if (io.WantTextInput || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
  const double right = held(GLFW_KEY_RIGHT, 'D') - held(GLFW_KEY_LEFT, 'A'), up = held('E', 'E') - held('Q', 'Q'),
               forward = held(GLFW_KEY_UP, 'W') - held(GLFW_KEY_DOWN, 'S');
  if (right == 0 && up == 0 && forward == 0) return;
  const bool parallel = editor.view.camera.orthographic();
  editor.view.camera = flown(editor.view.camera, right * speed * seconds, up * speed * seconds,
                             parallel ? 0 : forward * speed * seconds);
  // In an orthographic view, moving forward has no visible effect, so it zooms.
  if (parallel)
    editor.view.camera = zoomed(editor.view.camera, editor.view.camera.target, std::exp(-2 * forward * seconds));
}

void Viewport::navigate(EditorContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool picks = editor.tools.kind == ToolKind::pick;
  if (pointer.inside) {
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Middle)) (io.KeyShift ? panning_ : orbiting_) = true;
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Right) && !pointer.cancelled_drag) {
      panning_ = true;
      right_pressed_at_ = pointer.at;
    }
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) &&
        (io.KeyAlt ? !pointer.pressed : picks && !io.KeyShift && !io.KeyCtrl))
      orbiting_ = true;
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && picks && !io.KeyShift && !io.KeyCtrl)
      if (const std::optional<PickHit> picked = pick(editor.scene(), lens, pointer.at, false))
        editor.view.camera = with_orbit_center(editor.view.camera, picked->world);
    if (io.MouseWheel != 0 && editor.view.cut > 0 && io.KeyAlt) {
      const double size = editor.focus().isEmpty() ? 1 : editor.focus().diagonal().norm();
      editor.view.cut = std::max(1e-6 * size, editor.view.cut + 0.02 * size * static_cast<double>(io.MouseWheel));
    } else if (io.MouseWheel != 0) {
      // Zooms to the surface under the pointer, else to the point under the pointer at the target's depth.
      const std::optional<PickHit> picked = pick(editor.scene(), lens, pointer.at, false);
      const ViewRay ray = lens.ray(pointer.at);
      const Vec3 at = picked ? picked->world : Vec3(ray.origin + ray.direction * lens.depth(editor.view.camera.target));
      editor.view.camera = zoomed(editor.view.camera, at, std::pow(0.85, static_cast<double>(io.MouseWheel)));
    }
  }
  // A right click without a drag opens the context menu.
  if (panning_ && ImGui::IsMouseReleased(ImGuiMouseButton_Right) &&
      (right_pressed_at_ - pointer.at).norm() < static_cast<double>(px(4)))
    editor.dialogs.context = true;
  if (!io.MouseDown[0] && !io.MouseDown[2]) orbiting_ = false;
  if (!io.MouseDown[1] && !io.MouseDown[2]) panning_ = false;
  const double dx = static_cast<double>(io.MouseDelta.x), dy = static_cast<double>(io.MouseDelta.y);
  if (dx == 0 && dy == 0) return;
  if (orbiting_)
    editor.view.camera = editor.view.flying ? looked_around(editor.view.camera, dx, dy, editor.view.height)
                                            : orbited(editor.view.camera, dx, dy, editor.view.height);
  else if (panning_)
    editor.view.camera = panned(editor.view.camera, dx, dy, editor.view.height);
}

// Bounds for the camera's planes: the scene, and for an orthographic camera, which is placed in front of them, also
// preview and guides.
Box Viewport::drawn_bounds(const EditorContext& editor) const {
  Box box = world_bounds(editor.scene());
  if (editor.beside) box.extend(editor.beside->object->bounds());
  if (!editor.view.camera.orthographic()) return box;
  if (editor.preview) box.extend(world_bounds(editor.shown()));
  for (const Guides::Line& line : guides(editor).lines) box.extend(line.from).extend(line.to);
  return box;
}

Guides Viewport::guides(const EditorContext& editor) const {
  Guides result;
  result.selection = editor.view.show_selection;
  result.dimmed = editor.selected_out_of_scope();
  result.inspect = editor.view.inspect;
  result.channel = editor.view.channel;
  if (editor.settings.grid) add_grid(editor.scene(), editor.shown().ground, result.lines);
  // Picked nodes are outlined while the tool works on whole nodes.
  const bool nodes = editor.tools.kind == ToolKind::pick ||
                     ((editor.tools.kind == ToolKind::move || editor.tools.kind == ToolKind::rotate ||
                       editor.tools.kind == ToolKind::scale) &&
                      editor.selected_triangles() == 0);
  if (nodes && !editor.active.empty())
    for (const std::optional<NodeRef>& node : editor.scope()) result.outlined.push_back(node->id);
  tools_.at(editor.tools.kind)->add_guides(editor, result);
  return result;
}

// Uploads a part of a new scene; true while it is incomplete and the previous one must be shown. Not used for previews
// of drags, which change little, nor for steps in such quick succession that none of them would be visible.
bool Viewport::uploads_scene(const EditorContext& editor, const Scene& scene) {
  const bool other = made_ && !editor.preview && made_->scene.roots != scene.roots;
  if (other && arrival_ && arrival_->roots != scene.roots && Clock::now() - arrival_->began < settle_time) {
    arrival_.reset();
    return false;
  }
  const double there = other ? renderer_.upload_slice(scene, upload_ms) : 1;
  if (there < 1) {
    if (!arrival_ || arrival_->roots != scene.roots)
      arrival_ = Arrival{scene.roots, !same_pose(made_->view.camera, editor.view.camera), Clock::now()};
    arrival_->there = there;
    return true;
  }
  if (arrival_ && !other) renderer_.evict_staged();
  arrival_.reset();
  return false;
}

void Viewport::picture(EditorContext& editor) {
  const bool still = !moving() && !editor.view.flying;
  const double wanted_picture_ms = std::max(10.0, 1000.0 / editor.view.target_rate - rest_ms_);
  View view;
  const Scene scene = with_viewport_background(editor.shown(), editor);
  view.camera = editor.view.camera;
  view.samples = editor.view.samples;
  view.width = editor.view.width;
  view.height = editor.view.height;
  editor.relighter.request(scene, editor.preview.has_value(), scene.light ? editor.deform_nodes() : std::set<NodeId>{});
  const std::shared_ptr<const Lighting> lighting =
      scene.light && !editor.view.as_baked ? editor.relighter.latest() : nullptr;
  DrawnFrame wanted{
      scene, lighting, view, guides(editor), each_pass_, editor.view.wipe, editor.view.width, editor.view.height};
  // Whether full quality is cheap: nothing has changed, or only the changed pixels would be drawn.
  const auto stays_full = [&] {
    return made_ && same_view(made_->view, view) &&
           ((same_scene(made_->scene, scene) && made_->lighting == lighting && made_->guides == wanted.guides) ||
            (!editor.view.wipe && renderer_.keeps(scene, view, wanted.guides, lighting.get())));
  };
  double scale = 1;
  const bool quick = !still && full_ms_ > wanted_picture_ms && !stays_full();
  if (quick) {
    view.samples = 1;
    scale = editor.view.moving_share > 0 ? editor.view.moving_share : moving_scale_;
    view.width = std::max(16, static_cast<int>(std::lround(editor.view.width * scale)));
    view.height = std::max(16, static_cast<int>(std::lround(editor.view.height * scale)));
    wanted.view = view;
  }
  if (uploads_scene(editor, scene)) {
    if (arrival_->stays || same_pose(made_->view.camera, view.camera)) return;
    view.camera = with_clip_planes_for(view.camera, world_bounds(made_->scene));
    wanted.scene = made_->scene;
    wanted.lighting = made_->lighting;
    wanted.guides = made_->guides;
    wanted.view = view;
  }
  if (made_ && same_scene(made_->scene, wanted.scene) && made_->lighting == wanted.lighting &&
      same_view(made_->view, view) && made_->guides == wanted.guides && made_->each_pass == each_pass_ &&
      made_->wipe == editor.view.wipe) {
    if (!quick) write_thumbnails(editor);
    return;
  }
  // Set before drawing, so that an error is reported only once.
  made_ = wanted;
  texture_ = 0;
  const Renderer::Shown shown =
      renderer_.show(wanted.scene, view, {}, wanted.guides, each_pass_, wanted.lighting.get());
  if (!arrival_) renderer_.evict_staged();
  const double ms = shown.times.frame_ms;
  if (view.width == editor.view.width && view.samples == editor.view.samples && !shown.kept) full_ms_ = ms;
  // Assumes that the duration is proportional to the number of pixels.
  if (quick) moving_scale_ = std::clamp(scale * std::sqrt(wanted_picture_ms / ms), 0.35, 1.0);
  // Smoothed frame rate of the current movement.
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - drawn_at_).count();
  drawn_at_ = now;
  double rate = report_.frames_per_second;
  if (!still && since < 0.5) rate = rate > 0 ? 0.8 * rate + 0.2 / since : 1 / since;
  report_ = {shown.times, shown.passes, renderer_.peak_gpu_bytes(), report_.device, scale, view.samples, rate};
  if (!editor.view.wipe) {
    before_.reset();
  } else if (!arrival_) {
    // A second renderer holds the imported scene on the GPU during the comparison.
    if (!before_) before_ = std::make_unique<Renderer>(window_context_());
    Guides before;
    before.inspect = editor.view.inspect;
    before.channel = editor.view.channel;
    if (editor.settings.grid) add_grid(editor.scene(), editor.shown().ground, before.lines);
    before_texture_ =
        before_->show(with_viewport_background(editor.project.imported, editor), view, {}, before, false).texture;
  }
  texture_ = shown.texture;
  drew_ = true;
  if (!quick) write_thumbnails(editor);
}

// Thumbnails use the first picture at full quality, even if the view still moves: a fast driver does not draw it again
// when the view rests.
void Viewport::write_thumbnails(const EditorContext& editor) {
  if (editor.view.flying || editor.preview || editor.beside || arrival_ || texture_ == 0) return;
  scene_thumbnails_.write_for_recovery(editor, renderer_);
  scene_thumbnails_.write_for_recent_files(editor, renderer_);
}

void Viewport::frame_took(double ms) {
  if (!std::exchange(drew_, false)) return;
  const double rest = std::max(0.0, ms - report_.times.frame_ms);
  rest_ms_ = rest_ms_ > 0 ? 0.7 * rest_ms_ + 0.3 * rest : rest;
}

// Draws the before/after line, which the pointer can drag. True if the pointer drags or hovers it.
bool Viewport::draw_wipe(EditorContext& editor, ImDrawList& list, const ImVec2& origin, const Pointer& pointer) {
  const double grab = static_cast<double>(px(8));
  const double at = editor.view.wipe_at * editor.view.width;
  const bool hot = pointer.inside && std::abs(pointer.at.x() - at) < grab;
  if (hot && pointer.pressed) wiping_ = true;
  if (!pointer.down) wiping_ = false;
  if (wiping_) editor.view.wipe_at = std::clamp(pointer.at.x() / editor.view.width, 0.02, 0.98);
  const float x = origin.x + static_cast<float>(editor.view.wipe_at * editor.view.width);
  const float bottom = origin.y + static_cast<float>(editor.view.height);
  announce::point("wipe", {x, (origin.y + bottom) / 2});
  list.AddLine({x, origin.y}, {x, bottom}, IM_COL32(0, 0, 0, 200), 4);
  list.AddLine({x, origin.y}, {x, bottom}, hot || wiping_ ? IM_COL32(255, 230, 60, 255) : IM_COL32(255, 255, 255, 255),
               2);
  draw_label(list, {x - px(16) - ImGui::CalcTextSize("Before").x, origin.y + px(10)}, "Before");
  draw_label(list, {x + px(16), origin.y + px(10)}, "After");
  return hot || wiping_;
}

// Writes a requested screenshot, or the next picture of a film.
void Viewport::write_pictures(EditorContext& editor) {
  const auto written = [&](const Jobs::Rendered& shows, const Camera& camera, int width, int height,
                           const std::filesystem::path& path) {
    made_.reset();
    const Scene scene = with_only(shows.scene, shows.nodes);
    const View view{with_clip_planes_for(camera, world_bounds(scene)), width, height, editor.view.samples};
    const Lighting lighting = editor.view.as_baked ? Lighting{} : lit(shows.scene);
    write_picture(renderer_.render(scene, view, {}, &lighting), path, editor.now->sources);
  };
  try {
    if (const auto shot = std::exchange(editor.jobs.screenshot, std::nullopt)) {
      written(shot->shows, editor.view.camera, shot->width, shot->height, shot->path);
      editor.messages.say("Wrote " + shot->path.string());
    }
    if (editor.jobs.film) {
      const std::string said = editor.jobs.film->run_step(
          [&](const Camera& camera, const std::filesystem::path& path) {
            written(editor.jobs.film_shows, camera, editor.jobs.film->width(), editor.jobs.film->height(), path);
          },
          editor.now->sources);
      if (!said.empty()) {
        editor.messages.say(said);
        editor.jobs.end_film();
      }
    }
  } catch (const std::exception& error) {
    editor.jobs.end_film();
    editor.messages.fail(error.what());
  }
}

// The pointer in the viewport, which has just been drawn as an item. `moves`: its positions since the last frame.
Pointer Viewport::pointer_at(EditorContext& editor, const ImVec2& origin,
                             const std::vector<std::array<double, 2>>& moves) {
  const ImGuiIO& io = ImGui::GetIO();
  Pointer pointer;
  pointer.at = Vec2(static_cast<double>(io.MousePos.x - origin.x), static_cast<double>(io.MousePos.y - origin.y));
  for (const auto& [x, y] : moves)
    pointer.way.emplace_back(x - static_cast<double>(origin.x), y - static_cast<double>(origin.y));
  pointer.inside = ImGui::IsItemHovered();
  pointer.alt = io.KeyAlt;
  pointer.pressed =
      ImGui::IsMouseClicked(ImGuiMouseButton_Left) &&
      (!io.KeyAlt ||
       tool(editor).handles_alt_press(
           editor, ViewportProjection(editor.view.camera, editor.view.width, editor.view.height), pointer.at));
  pointer.down = io.MouseDown[0];
  pointer.released = ImGui::IsMouseReleased(ImGuiMouseButton_Left);
  pointer.double_clicked = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  // The right button cancels a drag, as Escape does.
  pointer.cancelled_drag = tool(editor).busy() && ImGui::IsMouseClicked(ImGuiMouseButton_Right);
  pointer.shift = io.KeyShift;
  pointer.control = io.KeyCtrl;
  return pointer;
}

// Leaves the tool that another one has replaced.
void Viewport::change_tool(EditorContext& editor) {
  if (editor.tools.pending_drag && *editor.tools.pending_drag != editor.tools.kind) {
    // Another tool was chosen before the requested drag could begin.
    editor.tools.pending_drag.reset();
    editor.tools.before.reset();
  }
  if (editor.tools.kind == last_tool_) return;
  tools_.at(last_tool_)->leave(editor);
  last_tool_ = editor.tools.kind;
}

void Viewport::move_camera(EditorContext& editor, const Pointer& pointer) {
  try {
    navigate(editor, ViewportProjection(editor.view.camera, editor.view.width, editor.view.height), pointer);
  } catch (const std::exception& error) {
    editor.messages.fail(error.what());
  }
  if (editor.view.flying) fly(editor);
  // These planes are also those that edits use to select through this camera.
  editor.view.camera = with_clip_planes_for(editor.view.camera, drawn_bounds(editor));
  if (editor.view.cut > 0)
    editor.view.camera.near_plane =
        std::min(std::max(editor.view.camera.near_plane, editor.view.cut), editor.view.camera.far_plane / 2);
}

void Viewport::use_tool(EditorContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  try {
    // Nodes of another document have the same numbers.
    if (std::exchange(tool_document_, editor.now->document).value_or(editor.now->document) != editor.now->document)
      tool(editor).leave(editor);
    const bool rests = editor.at_rest() && !editor.jobs.worker.busy();
    if (rests || !tool(editor).needs_current_scene() || tool(editor).busy())
      tool(editor).pointer(editor, lens, pointer);
    else if (pointer.pressed && pointer.inside)
      editor.messages.say("A job is still running. Click again when it has finished, or press Esc to cancel it.");
    last_tool_ =
        editor.tools.kind;  // after a drag that a key began, the previous tool returns without ViewTool::leave()
  } catch (const std::exception& error) {
    editor.messages.fail(error.what());
    tool(editor).cancel(editor);
  }
}

// Renders pending pictures: those of jobs, a thumbnail, and the viewport's own picture.
void Viewport::render(EditorContext& editor) {
  // Changes are drawn at reduced quality first, and at full quality after settle_time.
  if (!(editor.view.camera == last_camera_) || (made_ && made_->scene.roots != editor.shown().roots)) {
    last_camera_ = editor.view.camera;
    moved_at_ = Clock::now();
  }
  write_pictures(editor);
  if (thumbnails().wants() && !moving() && editor.at_rest() && !tool(editor).busy()) {
    made_.reset();
    thumbnails().draw_one(renderer_, with_viewport_background(editor.scene(), editor));
  }
  picture(editor);
}

void Viewport::draw_pictures(const EditorContext& editor, ImDrawList& list, const ImVec2& origin,
                             const ImVec2& size) const {
  if (texture_ != 0)
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture_)), origin,
                  {origin.x + size.x, origin.y + size.y}, {0, 1}, {1, 0});
  if (!editor.view.wipe || !before_) return;
  const auto share = static_cast<float>(editor.view.wipe_at);
  list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(before_texture_)), origin,
                {origin.x + share * size.x, origin.y + size.y}, {0, 1}, {share, 0});
}

void Viewport::draw(EditorContext& editor, const std::vector<std::array<double, 2>>& moves) {
  const ImVec2 size = ImGui::GetContentRegionAvail(), origin = ImGui::GetCursorScreenPos();
  editor.view.width = std::max(16, static_cast<int>(size.x));
  editor.view.height = std::max(16, static_cast<int>(size.y));
  change_tool(editor);
  ImGui::InvisibleButton(
      "viewport", size,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle | ImGuiButtonFlags_MouseButtonRight);
  announce::item("viewport");
  Pointer pointer = pointer_at(editor, origin, moves);
  if (pointer.cancelled_drag) tool(editor).cancel(editor);

  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(origin, {origin.x + size.x, origin.y + size.y}, true);
  list.ChannelsSplit(2);
  list.ChannelsSetCurrent(1);
  draw_legend(editor.view, list, origin);
  if (editor.view.marked) {
    const ImVec2 at = on_screen(editor.view.marked->cwiseProduct(Vec2(editor.view.width, editor.view.height)), origin);
    announce::point("largest error", at);
    list.AddCircle(at, px(14), IM_COL32(0, 0, 0, 200), 0, px(5));
    list.AddCircle(at, px(14), IM_COL32(255, 230, 60, 255), 0, px(2.5F));
    draw_label(list, {at.x + px(22), at.y - px(8)}, "largest error");
  }
  const bool on_axes =
      draw_axes(editor.view.camera, list, {origin.x + size.x, origin.y}, pointer.inside && !tool(editor).busy());
  if (on_axes || (editor.view.wipe && draw_wipe(editor, list, origin, pointer))) {
    pointer.inside = false;
    pointer.pressed = false;
  }
  move_camera(editor, pointer);
  const ViewportProjection lens(editor.view.camera, editor.view.width, editor.view.height);
  use_tool(editor, lens, pointer);
  try {
    render(editor);
    tool(editor).draw(editor, lens, pointer, list, origin);
  } catch (const std::exception& error) {
    editor.messages.fail(error.what());
  }
  list.ChannelsSetCurrent(0);
  draw_pictures(editor, list, origin, size);
  list.ChannelsMerge();
  list.PopClipRect();
}

}  // namespace rebake
