#pragma once

#include <imgui.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "editor/edits/nodes/place.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/view/thumbnails.h"
#include "editor/gui/window/desk.h"
#include "render/picture.h"
#include "render/picture_texture.h"

namespace rebake {

// What stands around the viewport. Each draws itself into the present Dear ImGui window.

/// The tree of nodes: visibility, lock, names, order, and what each holds.
class OutlinePanel {
 public:
  void draw(Desk& desk);

 private:
  void draw_node(Desk& desk, const PlacedNode& placed, int depth);
  void draw_name(Desk& desk, const Node& node);
  void pick(Desk& desk, NodeId id);
  std::set<NodeId> folded_;
  NodeId renaming_ = NodeId::none, shift_from_ = NodeId::none;
  std::string name_;
  bool focus_name_ = false;
};

/// Place, turn and size of the active nodes, by numbers.
class PropertiesPanel {
 public:
  void draw(Desk& desk);

 private:
  ui::Changed row(const char* name, Vec3& value, const char* format, double step);
  void draw_one(Desk& desk, const PlacedNode& placed);
  void draw_several(Desk& desk);
  std::set<NodeId> of_;  ///< what the numbers say
  Vec3 position_{0, 0, 0}, angles_{0, 0, 0}, scale_{1, 1, 1};
  bool dragging_ = false;    ///< a number: they are not those of the document
  std::size_t said_at_ = 0;  ///< steps of history when the problem was said
  std::string problem_;
};

/// All steps, done and undone; a click goes there.
class HistoryPanel {
 public:
  void draw(Desk& desk);

 private:
  std::shared_ptr<const Snapshot> of_;  ///< what was drawn last
};

/// Stored views with pictures: a click looks from there.
class ViewsPanel {
 public:
  /// `drawn`: the scene as pictures show it.
  void draw(Desk& desk, const Scene& drawn, Thumbnails& thumbnails);

 private:
  void draw_card(Desk& desk, const Scene& drawn, Thumbnails& thumbnails, const std::string& name);
  void draw_name(Desk& desk, const std::string& name, float width);
  std::string renaming_, name_;  ///< the view, and what is typed
  bool focus_name_ = false;
};

/// What light does: which effects follow edits, where it comes from, and what each cost.
class LightPanel {
 public:
  void draw(Desk& desk);

 private:
  void draw_settings(Desk& desk, const SceneLight& light, bool on);
  void draw_ball(const Lighting& lighting);
  std::optional<PictureTexture> ball_;
  std::shared_ptr<const Light> ball_of_;
  SceneLight last_;           ///< what it was while it was on
  Vec3 sun_{0.5, 0.8, 0.45};  ///< while it is dragged
  double budget_ = 1, turn_ = 0;
  bool dragging_ = false;
};

/// The edits as script lines, to be copied or saved, and a line to type one.
class ScriptPanel {
 public:
  void draw(Desk& desk);

 private:
  std::string line_, problem_;
  std::shared_ptr<const Snapshot> of_;  ///< what the lines say
  std::vector<std::string> lines_;
};

/// What the last picture cost: passes, why each ran or not, memory.
struct FrameReport {
  FrameTimes times;
  std::vector<PlannedPass> passes;
  std::uint64_t gpu_bytes = 0;
  std::string device;
  double scale = 1;  ///< of the picture's resolution
  int samples = 4;
  double pictures_a_second = 0;  ///< while the view last moved
};
void draw_costs(Jobs& jobs, ViewState& view, const Snapshot& now, const FrameReport& report, bool& each_pass);

/// The fields of the last step, which change it until the next is done.
class AdjustPanel {
 public:
  /// Above `corner`, to its right, over a picture of that size.
  void draw(Desk& desk, const ImVec2& corner, const ImVec2& room);

 private:
  std::vector<Edit> changed_edits(const Snapshot& now, std::size_t edits) const;
  std::optional<Edit> of_;  ///< the edit that the fields were taken from
  nlohmann::json object_;
  bool changing_ = false;                          ///< a field is being dragged: the document does not hold it yet
  bool was_small_ = false, opened_small_ = false;  ///< little room, and opened all the same
};

/// The latest messages, above `corner` and to its left.
void draw_toasts(Messages& messages, const ImVec2& corner);
/// All keys, where they are asked for.
void draw_keys_sheet(Desk& desk);
/// What to begin with, while nothing is open.
void draw_start(Desk& desk, Thumbnails& thumbnails, const ImVec2& middle);

/// What was said, newest last.
void draw_log(const Messages& messages);

/// All commands and edits by name.
class PalettePanel {
 public:
  void draw(Desk& desk);

 private:
  std::string filter_;
  bool was_open_ = false;
};

/// The fields of one edit, made from the table of edits.
class EditForm {
 public:
  /// `right`: where the panels at the right begin, in pixels.
  void draw(Desk& desk, float right);

 private:
  void begin(const Desk& desk);
  std::vector<nlohmann::json> lines(const Desk& desk) const;
  void show(Desk& desk);
  void draw_count(const Desk& desk) const;
  bool previews_ = true;
  std::string previewed_;              ///< the lines whose result is shown, or being made
  std::vector<NodePtr> previewed_on_;  ///< the scene that it was made of
  std::string op_, problem_;
  nlohmann::json values_;
  std::map<std::string, std::string> texts_;  ///< of fields that are typed as JSON
};

}  // namespace rebake
