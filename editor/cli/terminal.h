#pragma once

#include <string>
#include <string_view>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Colour and progress on standard error, only where a person watches: both are off when it is piped, colour also under
/// NO_COLOR.
bool is_interactive();
std::string coloured(const std::string& text, const char* sgr);

/// Ctrl+C asks long work to stop, which then leaves nothing half-written; a second one ends the program at once.
void stop_on_interrupt();

/// A one-line bar that is redrawn at most ten times a second and removed when done.
Progress progress_bar();
void clear_progress_bar();

/// Text that may hold anything (names, paths), fit for a terminal: control characters but line ends are written out.
std::string printable(std::string_view text);
/// A line on standard error, beside the progress bar.
void say_line(const std::string& line);

}  // namespace rebake
