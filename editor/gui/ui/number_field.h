#pragma once

namespace rebake::ui {

/// What happened to a number in this frame.
enum class Changed {
  nothing,
  dragged,   ///< it is being dragged, and changed
  finished,  ///< a drag ended, or a value was typed
  failed,    ///< what was typed is no number
  cancelled  ///< a drag was let go of: it is as it was before
};

/// A number that is dragged to the side, or clicked to be typed as an expression; Tab goes on to the next. `format` is
/// fmt's; a pixel of drag adds `step`. `id` is announced.
Changed number_field(const char* id, double& value, const char* format, double step, float width);

/// Whether what is typed goes into a field, from the click on that is to open it.
bool takes_text();
/// Lets go of a number that is being dragged; false when none is.
bool cancel_drag();

}  // namespace rebake::ui
