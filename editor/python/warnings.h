#pragma once

#include <string>
#include <vector>

namespace rebake {

/// Raises a UserWarning. If a filter makes it an exception, the exception goes to sys.unraisablehook, because the
/// call has succeeded. Needs the GIL.
void warn(const std::string& message);
/// Warns of each message that is marked as a note or warning: "note: …", "import: warning: …".
void warn_of_notes(const std::vector<std::string>& messages);

}  // namespace rebake
