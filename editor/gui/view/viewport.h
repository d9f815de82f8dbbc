#pragma once

#include <array>
#include <chrono>
#include <memory>

#include "editor/gui/panels/panels.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// The picture with what is drawn over it, the pointer in it, and the camera that it moves.
class Viewport {
 public:
  /// `window_context` makes contexts for further renderers, in the same window.
  Viewport(Renderer& renderer, Tools& tools, std::function<std::unique_ptr<gl::Context>()> window_context);
  ~Viewport();

  /// Draws into the present Dear ImGui window, over all of its content. `moves`: where the pointer went since the last
  /// frame, in the window's pixels.
  void draw(Desk& desk, const std::vector<std::array<double, 2>>& moves);
  /// Takes a key before commands do; true when it was for the tool in hand.
  bool key(Desk& desk, const KeyPress& press);
  /// Lets go of what the tool holds; false when it holds nothing.
  bool cancel(Desk& desk);
  ViewTool& tool(const Desk& desk) { return *tools_.at(desk.tools.kind); }

  /// Seconds until there is something to draw without any event; negative for never.
  double next_frame_in(const Desk& desk) const;
  /// Whether no program is missing that other views of what is shown would want.
  bool all_made() const;
  /// Whether some may be, and nothing moves.
  bool wants_ahead() const;
  /// Makes one of them, where nothing else is to be done.
  void make_ahead(const Desk& desk);
  /// How long the whole frame took of the window in which the last picture was drawn.
  void frame_took(double ms);
  /// How much of the scene is on the GPU, from 0 to 1; until it is all there the one before is shown.
  double arrived() const { return arrival_ ? arrival_->there : 1; }
  const FrameReport& report() const { return report_; }
  bool& each_pass() { return each_pass_; }
  Thumbnails& thumbnails() { return thumbnails_; }
  /// The scene before the background that it is drawn on.
  static Scene drawn(const Desk& desk);

 private:
  using Clock = std::chrono::steady_clock;
  /// What the shown picture was made of.
  struct Made {
    Scene scene;
    std::shared_ptr<const Lighting> lighting;
    View view;
    Guides guides;
    bool each_pass = false, wipe = false;
    int shown_width = 0, shown_height = 0;
  };
  /// A scene that goes to the GPU while the picture is of another one.
  struct Arrival {
    std::vector<NodePtr> roots;
    bool stays;  ///< the picture as it was: the camera went along with the scene, as when one is opened
    Clock::time_point began;
    double there = 0;
  };
  bool arrives(const Desk& desk, const Scene& scene);
  void navigate(Desk& desk, const Lens& lens, const Pointer& pointer);
  void fly(Desk& desk);
  void picture(Desk& desk);
  Guides guides(const Desk& desk) const;
  Box drawn_bounds(const Desk& desk) const;
  bool draw_wipe(Desk& desk, ImDrawList& list, const ImVec2& origin, const Pointer& pointer);
  void write_pictures(Desk& desk);
  void keep_picture(const Desk& desk);
  void keep_journal_picture(const Desk& desk);
  bool moving() const;

  Vec2 right_pressed_at_{0, 0};
  Renderer& renderer_;
  std::unique_ptr<Renderer> before_;  ///< of the scene as imported; null while it is not compared with
  Tools& tools_;
  Clock::time_point moved_at_{}, flown_at_{}, drawn_at_{};
  std::optional<Arrival> arrival_;
  double full_ms_ = 0;       ///< of a picture at full quality
  double rest_ms_ = 0;       ///< of a frame beside its picture
  double moving_scale_ = 1;  ///< of the resolution while the camera moves
  std::function<std::unique_ptr<gl::Context>()> window_context_;
  Camera last_camera_;
  FrameReport report_;
  std::optional<Made> made_;
  std::optional<Made> ahead_of_;  ///< a picture of which no program is missing from other views
  unsigned before_texture_ = 0;
  ToolKind last_tool_ = ToolKind::pick;
  unsigned texture_ = 0;
  Thumbnails thumbnails_;
  std::string kept_of_;               ///< what a picture is kept of,
  std::size_t kept_step_ = 0;         ///< and after how many steps it looked so
  std::filesystem::path journal_of_;  ///< the journal that a thumbnail was written for last,
  std::size_t journal_step_ = 0;      ///< after how many steps,
  Clock::time_point journal_at_;      ///< and when
  bool each_pass_ = false;
  bool drew_ = false;  ///< a picture in this frame
  bool orbiting_ = false, panning_ = false, wiping_ = false;
};

}  // namespace rebake
