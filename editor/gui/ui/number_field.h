#pragma once

namespace rebake::ui {

/// Event of a number field in this frame.
enum class Changed {
  nothing,
  dragged,   ///< the value changed during a drag
  finished,  ///< a drag ended, or a new value was typed
  failed,    ///< the typed text is not a valid expression; the value is unchanged
  cancelled  ///< a drag was cancelled; the value is as before the drag
};

/// A number that is dragged horizontally, or clicked and typed as an expression (expression.h). Tab moves to the next
/// field. `format`: a format string of fmt, may end with a unit; `step`: change per pixel of drag; `width`: in pixels.
/// `id` is the announced name.
Changed number_field(const char* id, double& value, const char* format, double step, float width);

/// Whether a text box has the keyboard, or will have it in the next frame.
bool takes_text();
/// Cancels the current drag of a number; false if there is none.
bool cancel_drag();

}  // namespace rebake::ui
