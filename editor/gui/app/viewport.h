#pragma once

#include <array>
#include <chrono>
#include <memory>

#include "editor/gui/app/scene_thumbnails.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// The 3D viewport: draws the scene and its overlays, passes the pointer to the current tool, and navigates the camera.
/// While camera or scene change, resolution and samples are reduced to reach ViewState::target_rate.
class Viewport {
 public:
  /// `window_context` returns the window's OpenGL context for a second renderer (before/after comparison). The
  /// references must outlive the viewport.
  Viewport(Renderer& renderer, Tools& tools, std::function<std::unique_ptr<gl::Context>()> window_context);
  ~Viewport();

  /// Draws into the current Dear ImGui window and fills it. `moves`: pointer positions since the last frame, in window
  /// pixels.
  void draw(EditorContext& editor, const std::vector<std::array<double, 2>>& moves);
  /// Offers a key to the current tool before commands get it; true if the tool used it.
  bool key(EditorContext& editor, const KeyPress& press);
  /// Cancels flying, a drag that a key has requested, or the current tool's drag; false if there is none.
  bool cancel(EditorContext& editor);
  ViewTool& tool(const EditorContext& editor) { return *tools_.at(editor.tools.kind); }

  /// Seconds until a new frame is needed without any event; negative: never.
  double next_frame_in(const EditorContext& editor) const;
  /// Whether all shader programs that other views of the current scene may need are compiled.
  bool all_made() const;
  /// Whether some of these may be missing and the view rests, so that compile_next_program() is useful.
  bool may_compile_ahead() const;
  /// Compiles one missing shader program. To be called when the window is idle.
  void compile_next_program(const EditorContext& editor);
  /// To be called with the duration of each window frame; ignored unless the frame drew a new picture.
  void frame_took(double ms);
  /// Uploaded share of a new scene's GPU data, 0 … 1. Below 1, the previous scene is shown.
  double arrived() const { return arrival_ ? arrival_->there : 1; }
  /// Times, passes and memory of the last picture.
  const FrameReport& report() const { return report_; }
  /// Whether each render pass is timed separately, which slows the frame down.
  bool& each_pass() { return each_pass_; }
  Thumbnails& thumbnails() { return scene_thumbnails_.of_recent_files(); }
  const Thumbnails& thumbnails() const { return scene_thumbnails_.of_recent_files(); }
  /// The document's scene, with the background that the viewport shows.
  static Scene drawn(const EditorContext& editor);

 private:
  using Clock = std::chrono::steady_clock;
  /// Inputs of the picture that was drawn last. It is drawn again only if they change.
  struct DrawnFrame {
    Scene scene;
    std::shared_ptr<const Lighting> lighting;
    View view;
    Guides guides;
    bool each_pass = false, wipe = false;
    int shown_width = 0, shown_height = 0;
  };
  /// A scene that is being uploaded to the GPU while the previous one is shown.
  struct Arrival {
    std::vector<NodePtr> roots;
    bool stays;  ///< the camera changed with the scene, e.g. on opening one: the old picture is not redrawn
    Clock::time_point began;
    double there = 0;  ///< uploaded share, 0 … 1
  };
  Pointer pointer_at(EditorContext& editor, const ImVec2& origin, const std::vector<std::array<double, 2>>& moves);
  void change_tool(EditorContext& editor);
  void move_camera(EditorContext& editor, const Pointer& pointer);
  void use_tool(EditorContext& editor, const ViewportProjection& lens, const Pointer& pointer);
  void render(EditorContext& editor);
  void draw_pictures(const EditorContext& editor, ImDrawList& list, const ImVec2& origin, const ImVec2& size) const;
  bool uploads_scene(const EditorContext& editor, const Scene& scene);
  void navigate(EditorContext& editor, const ViewportProjection& lens, const Pointer& pointer);
  void fly(EditorContext& editor);
  void picture(EditorContext& editor);
  Guides guides(const EditorContext& editor) const;
  Box drawn_bounds(const EditorContext& editor) const;
  bool draw_wipe(EditorContext& editor, ImDrawList& list, const ImVec2& origin, const Pointer& pointer);
  void write_pictures(EditorContext& editor);
  void write_thumbnails(const EditorContext& editor);
  bool moving() const;

  Vec2 right_pressed_at_{0, 0};
  Renderer& renderer_;
  std::unique_ptr<Renderer> before_;  ///< renderer of the imported scene; null unless ViewState::wipe
  Tools& tools_;
  Clock::time_point moved_at_{}, flown_at_{}, drawn_at_{};
  std::optional<Arrival> arrival_;
  double full_ms_ = 0;       ///< duration of the last picture at full quality
  double rest_ms_ = 0;       ///< smoothed duration of a window frame without its picture
  double moving_scale_ = 1;  ///< resolution per axis while the view moves, relative to full
  std::function<std::unique_ptr<gl::Context>()> window_context_;
  Camera last_camera_;
  FrameReport report_;
  std::optional<DrawnFrame> made_;
  std::optional<DrawnFrame>
      compiled_for_;                     ///< picture for whose scene compile_next_program() has compiled all programs
  unsigned before_texture_ = 0;          ///< OpenGL texture of the imported scene's picture
  ToolKind last_tool_ = ToolKind::pick;  ///< tool of the previous frame
  std::optional<std::uint64_t> tool_document_;  ///< document that tools work on
  unsigned texture_ = 0;                        ///< OpenGL texture of the picture; 0: it could not be drawn
  SceneThumbnails scene_thumbnails_;
  bool each_pass_ = false;
  bool drew_ = false;  ///< a new picture was drawn in this frame
  bool orbiting_ = false, panning_ = false, wiping_ = false;
};

}  // namespace rebake
