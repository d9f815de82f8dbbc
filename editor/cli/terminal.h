#pragma once

#include <string>
#include <string_view>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Whether standard error is a terminal. If not, there is no colour and no progress bar.
bool is_interactive();
/// The text in a colour, for standard error; unchanged if not interactive or if NO_COLOR is set. `sgr`: parameters of
/// the escape sequence, such as "1;31".
std::string coloured(const std::string& text, const char* sgr);

/// Installs signal handlers: SIGINT, SIGTERM and SIGHUP cancel the work of progress_bar(). After 0.6 s, unfinished work
/// is abandoned: no further file is moved into place, temporary files are removed, and the process ends with exit code
/// 130. A second signal ends it at once.
void stop_on_interrupt();

/// A progress bar on standard error, redrawn at most ten times per second and removed at the end. Signals cancel it,
/// see stop_on_interrupt().
Progress progress_bar();

/// Writes to standard error; failures are ignored, so that work continues.
void write_stderr(const std::string& text);
void clear_progress_bar();

/// Escapes control characters except newline and tab as \xNN, so that names and paths cannot control the terminal.
std::string printable(std::string_view text);
/// Writes a line to standard error, after removing the progress bar.
void print_message(const std::string& line);

}  // namespace rebake
