#pragma once

#include <string>
#include <string_view>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Colour and progress on standard error, only where a person watches: both are off when it is piped, colour also under
/// NO_COLOR.
bool is_interactive();
std::string coloured(const std::string& text, const char* sgr);

/// SIGINT, SIGTERM and SIGHUP ask long work to stop. Work that has not stopped after 0.6 s is abandoned: nothing is
/// moved into place any more, temporary files are removed, and the process ends with exit code 130. A second signal
/// ends it at once.
void stop_on_interrupt();

/// A one-line bar that is redrawn at most ten times a second and removed when done.
Progress progress_bar();

/// Writes to standard error, as far as that takes it: work goes on where nobody reads it.
void complain(const std::string& text);
void clear_progress_bar();

/// Text that may hold anything (names, paths), fit for a terminal: control characters but line ends are written out.
std::string printable(std::string_view text);
/// A line on standard error, beside the progress bar.
void say_line(const std::string& line);

}  // namespace rebake
