#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "editor/gui/window/desk.h"
#include "render/picture.h"

namespace rebake {

// What stands around the viewport. Each draws itself into the present Dear ImGui window.

/// The tree of nodes: visibility, lock, names, order, and what each holds.
class OutlinePanel {
 public:
  void draw(Desk& desk);

 private:
  void draw_node(Desk& desk, const PlacedNode& placed, int depth);
  NodeId renaming_ = NodeId::none, shift_from_ = NodeId::none;
  std::string name_;
  bool focus_name_ = false;
};

/// Place, turn and size of the active nodes, by numbers.
class PropertiesPanel {
 public:
  void draw(Desk& desk);

 private:
  bool number(const char* label, double& value, const char* format);
  std::string text_, editing_, problem_;
};

/// All steps, done and undone; a click goes there.
class HistoryPanel {
 public:
  void draw(Desk& desk);

 private:
  std::shared_ptr<const Snapshot> of_;  ///< what the lines say
  std::vector<std::string> lines_;      ///< the start, then one a step
  int done_ = 0;                        ///< steps that are not undone
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
  void draw(Desk& desk);

 private:
  void begin(const Desk& desk);
  void show(Desk& desk);
  bool previews_ = true;
  std::string previewed_;              ///< the line whose result is shown, or being made
  std::vector<NodePtr> previewed_on_;  ///< the scene that it was made of
  std::string op_, problem_;
  nlohmann::json values_;
  std::map<std::string, std::string> texts_;  ///< of fields that are typed as JSON
};

/// Asks for a path; says what an export can and cannot keep; asks before work is lost; shows errors.
class Dialogs {
 public:
  void draw(Desk& desk);
  /// Answers the question that is open with "not now"; false when none is.
  bool escape(Desk& desk);
  /// Closes what Dear ImGui has open, with the next frame.
  void close_popups() { closes_ = true; }
  /// True once the window may close.
  bool may_quit() const { return may_quit_; }

 private:
  void draw_path(Desk& desk);
  void draw_error(Messages& messages);
  void draw_recovery(Project& project);
  void draw_quitting(Desk& desk);
  void draw_replacing(Project& project);
  void draw_relinking(Project& project);
  std::string path_;
  PathQuestion asked_ = PathQuestion::none;
  std::filesystem::path replacing_;  ///< is there already: asked for once
  int width_ = 0, height_ = 0;       ///< of pictures, in pixels
  int pictures_ = 36;                ///< of a turntable
  bool may_quit_ = false, closes_ = false;
};

}  // namespace rebake
