#pragma once

#include <imgui.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "editor/edits/nodes/place.h"
#include "editor/gui/panels/field_inputs.h"
#include "editor/gui/panels/light_model_form.h"
#include "editor/gui/state/editor_context.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/view/thumbnails.h"
#include "render/picture.h"
#include "render/picture_texture.h"

namespace rebake {

// Panels and overlays of the window. Each draws into the current Dear ImGui window.

/// Outliner: the tree of nodes with name, order, triangle count, visibility and lock.
class OutlinerPanel {
 public:
  void draw(ToolContext& editor, DialogState& dialogs);

 private:
  void draw_selectable(ToolContext& editor, DialogState& dialogs, const PlacedNode& placed);
  void draw_node(ToolContext& editor, DialogState& dialogs, const PlacedNode& placed, int depth);
  void draw_name(ToolContext& editor, const Node& node);
  void pick(ToolContext& editor, NodeId id);
  std::set<NodeId> folded_;                                     ///< collapsed groups
  NodeId renaming_ = NodeId::none, shift_from_ = NodeId::none;  ///< node being renamed; one end of a Shift range
  std::uint64_t document_ = 0;                                  ///< Snapshot::document of these nodes
  std::string name_;                                            ///< typed name
  bool focus_name_ = false;
};

/// Number fields for position, rotation and scale of the picked nodes.
class PropertiesPanel {
 public:
  void draw(DocumentEditor& editor);

 private:
  /// Draws three number fields; returns their change in this frame.
  ui::Changed row(const char* name, Vec3& value, const char* format, double step);
  void draw_one(DocumentEditor& editor, const PlacedNode& placed);
  void draw_several(DocumentEditor& editor);
  std::set<NodeId> of_;                                        ///< nodes that the numbers belong to
  Affine from_ = Affine::Identity();                           ///< Node::to_parent when a change began
  Vec3 position_{0, 0, 0}, angles_{0, 0, 0}, scale_{1, 1, 1};  ///< scene units, Euler angles in degrees, factors
  bool dragging_ = false;         ///< a number is being dragged, so the numbers differ from the document
  std::size_t problem_step_ = 0;  ///< number of history steps when `problem_` was set
  std::string problem_;
};

/// List of all history steps, done and undone. A click undoes or redoes up to a step.
class HistoryPanel {
 public:
  void draw(DocumentEditor& editor);

 private:
  std::shared_ptr<const Snapshot> of_;  ///< snapshot drawn last
};

/// Stored views as thumbnails. A click moves the camera there.
class ViewsPanel {
 public:
  /// `drawn`: the scene with the viewport's background, for thumbnails.
  void draw(ToolContext& editor, const Scene& drawn, Thumbnails& thumbnails);

 private:
  void draw_card(ToolContext& editor, const Scene& drawn, Thumbnails& thumbnails, const std::string& name);
  void draw_name(ToolContext& editor, const std::string& name, float width);
  std::string renaming_, name_;  ///< view being renamed, and the typed name
  bool focus_name_ = false;
};

/// Light settings: the effects that follow edits, the source of the light, and the decision about each effect.
class LightPanel {
 public:
  void draw(EditorContext& editor);

 private:
  void draw_settings(EditorContext& editor, const SceneLight& light, bool on);
  void draw_ball(const Lighting& lighting);
  std::optional<PictureTexture> ball_;  ///< image of a ball in the light `ball_of_`
  std::shared_ptr<const Light> ball_of_;
  SceneLight last_;               ///< settings when light last followed edits
  std::uint64_t document_ = 0;    ///< of which document
  Vec3 sun_{0.5, 0.8, 0.45};      ///< edited direction towards the sun
  double budget_ = 1, turn_ = 0;  ///< edited error budget in 1/255, and rotation of the light image in degrees
  LightModelForm model_;
  bool dragging_ = false;  ///< a number is being dragged, so the numbers differ from the document
};

/// All edits as script lines, to copy or save, and a field to run a typed line.
class ScriptPanel {
 public:
  void draw(DocumentEditor& editor, DialogState& dialogs);

 private:
  std::string line_, problem_;          ///< typed line, and its error message
  std::shared_ptr<const Snapshot> of_;  ///< snapshot that the lines belong to
  std::vector<std::string> lines_;
};

/// Cost of the last frame: times, passes with the reason why each ran or not, and GPU memory.
struct FrameReport {
  FrameTimes times;
  std::vector<PlannedPass> passes;
  std::uint64_t gpu_bytes = 0;
  std::string device;
  double scale = 1;              ///< share of the full resolution, each way
  int samples = 4;               ///< per pixel
  double frames_per_second = 0;  ///< frame rate while the view last moved
};
/// Draws the cost panel: samples per pixel, target frame rate, measured error over time, and the frame report.
/// `each_pass`: option to time each pass.
void draw_costs(Jobs& jobs, ViewState& view, const Snapshot& now, const FrameReport& report, bool& each_pass);

/// Fields of the last step, as Blender's "Adjust Last Operation": changing one applies the step again.
class AdjustPanel {
 public:
  /// Draws with the lower left corner at `corner` (window pixels), over a viewport of size `room` (pixels).
  void draw(ToolContext& editor, const ImVec2& corner, const ImVec2& room);

 private:
  /// The last `edits` edits with the changed fields.
  std::vector<Edit> changed_edits(const Snapshot& now, std::size_t edits) const;
  std::optional<Edit> of_;                         ///< edit that the fields were read from
  nlohmann::json object_;                          ///< its fields with changes
  bool changing_ = false;                          ///< a field is being dragged, so the document has the old value
  std::optional<Vec3> angles_;                     ///< of a rotation that is being dragged, degrees
  bool was_small_ = false, opened_small_ = false;  ///< the viewport is too small for the fields; they are open anyway
};

/// Draws the latest messages as toasts, stacked upwards from their lower right `corner` (window pixels).
void draw_toasts(Messages& messages, const ImVec2& corner);
/// Draws the sheet of keys and mouse actions if `dialogs.keys` is set.
void draw_keys_sheet(DialogState& dialogs, const Settings& settings);
/// Draws the start page (open, recent, samples) centred at `middle` (window pixels) while the scene is empty.
void draw_start(EditorContext& editor, Thumbnails& thumbnails, const ImVec2& middle);

/// Draws the message log, newest last.
void draw_log(const Messages& messages);

/// Command palette: searches all commands, edits and stored views by name.
class PalettePanel {
 public:
  void draw(EditorContext& editor);

 private:
  std::string filter_;
  bool was_open_ = false;
};

/// Form for all fields of one edit, generated from the edit's field table, with a live preview.
class EditForm {
 public:
  /// `right`: left border of the panels at the right, in window pixels.
  void draw(DocumentEditor& editor, DialogState& dialogs, float right);

 private:
  /// Resets the form for the edit `op`.
  void begin(const DocumentEditor& editor, const std::string& op);
  /// Fills required lists of nodes with the picked nodes, if the user has not changed them.
  void fill_picks(const DocumentEditor& editor);
  /// The edits that the fields describe: one, or one per picked node. Throws EditError.
  std::vector<nlohmann::json> lines(const DocumentEditor& editor) const;
  /// Requests a preview if the fields or the scene have changed.
  void show(DocumentEditor& editor);
  void draw_count(const DocumentEditor& editor) const;
  bool previews_ = true;
  std::string previewed_;                         ///< JSON of the edits that the preview shows or is computing
  std::vector<NodePtr> previewed_on_;             ///< root nodes of the scene that the preview started from
  std::map<std::string, Camera> previewed_with_;  ///< its stored views
  std::size_t request_ = 0;                       ///< number of the preview's request; 0: none was needed
  std::string op_, problem_;                      ///< op of the edit; error message
  std::uint64_t document_ = 0;                    ///< document that the fields were set for
  nlohmann::json picks_;                          ///< the picked nodes that a list of nodes was filled with
  FieldInputs inputs_;
};

}  // namespace rebake
