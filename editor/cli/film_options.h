#pragma once

#include <optional>
#include <string>

#include "editor/actions/picture_output.h"
#include "editor/cli/options.h"

namespace rebake {

/// Options of `render` that make a film of it: see FilmAction.
struct FilmOptions {
  std::string path, codec, picture;
  std::optional<double> fps, seconds;
  bool loop = false;

  void add_to(SubcommandDescription& command);
  /// Whether a film is asked for.
  bool given() const { return !path.empty(); }
  /// Throws FieldError if an option is given that only films have.
  void check_unused() const;
  void render(LoadedScene opened, const ViewOptions& view, const PictureContent& content, const std::string& out) const;
};

}  // namespace rebake
