#pragma once

#include <filesystem>
#include <string>

#include "editor/gui/state/dialog_state.h"

namespace rebake {

/// Texts and file extensions of the file dialog for one purpose.
struct FileDialogText {
  FileDialogPurpose kind;
  const char* title;
  const char* hint;
  const char* action;           ///< label of the primary button
  const char* ending;           ///< extension added to names with none of `listed`; empty for folders and for reading
  const char* listed = ending;  ///< extensions of the listed files, separated by spaces
};
const FileDialogText& text_of(FileDialogPurpose kind);

/// Extensions of the listed files, separated by spaces.
std::string listed_endings(FileDialogPurpose kind);
/// Whether the chosen path is read, not written.
bool reads(FileDialogPurpose kind);
/// Whether a sequence of pictures is written.
bool makes_film(FileDialogPurpose kind);
/// Checks a path before it is used. Returns an error message; empty if the path is usable.
std::string problem_with(const std::filesystem::path& path, FileDialogPurpose kind);

}  // namespace rebake
