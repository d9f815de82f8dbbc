#pragma once

#include "editor/edits/deform/handles.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// As-rigid-as-possible deformation by pins on the surface, which are fixed or dragged. Each release is a step of the
/// document's history: the first an edit, each later one a revision of it (Document::revise).
class HandlesTool final : public ViewTool {
 public:
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(ToolContext& editor, const KeyPress& press) override;
  void options(ToolContext& editor) override;
  bool busy() const override { return held_ >= 0; }
  void cancel(ToolContext& editor) override;
  void leave(ToolContext& editor) override;

 private:
  struct Pin {
    Vec3 at;     ///< point of the undeformed surface, world space
    Vec3 moved;  ///< target position, world space
    bool holds;  ///< set as a fixed pin, and not dragged since
    Vec3 motion() const { return moved - at; }
  };
  using Pins = std::vector<Pin>;
  /// The edit of these pins; nothing if none has moved.
  std::optional<HandlesDeform> edit_for(const Pins& pins) const;
  /// Starts a new set of pins on the current scene.
  void begin(ToolContext& editor);
  /// Adds a pin on the surface at a viewport pixel, if the target is there. Runs on the worker.
  void add(ToolContext& editor, const ViewportProjection& lens, const Vec2& at, bool holds);
  /// Synchronises the pins with the document.
  void follow(ToolContext& editor);
  /// Requests a preview.
  void show(ToolContext& editor);
  /// Makes or revises the edit.
  void commit(ToolContext& editor);
  void remove_pin(ToolContext& editor, std::size_t pin);
  /// Removes all pins; their edit stays.
  void end();
  bool shown() const { return from_ && !hidden_; }
  int pin_at(const ViewportProjection& lens, const Vec2& at) const;

  bool holds_ = true;  ///< a click sets a fixed pin, otherwise one to drag; Shift inverts it
  float coarseness_ = 0.08F;
  Pins pins_, before_;          ///< current pins, and those at the start of the drag
  std::vector<NodePtr> roots_;  ///< of the scene at the start of the drag
  std::vector<Pins> steps_;     ///< pins after each release; [0] is empty: no deformation
  std::size_t at_ = 0;          ///< index into steps_ of the state that the document has
  std::optional<Scene> from_;   ///< scene in which the pins were set; the edit applies to it
  DeformTarget target_;         ///< deformed triangles
  bool hidden_ = false;         ///< pins are hidden: the document has none of their steps; redo may return to one
  double reach_ = 0;            ///< a pin moves the cage points within this radius, scene units
  int held_ = -1;               ///< index of the dragged pin; −1: none
  Vec2 pressed_at_{0, 0};       ///< viewport pixel where the drag began
};

}  // namespace rebake
