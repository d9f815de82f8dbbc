#include <memory>

#include "editor/cli/subcommands.h"
#include "editor/gui/app/editor_window.h"

namespace rebake {

void describe_edit(SubcommandDescription& command) {
  auto paths = std::make_shared<std::vector<std::string>>();
  command.option("paths", *paths, "folders and scenes to open together, or one project", "FOLDER|SCENE|PROJECT...");
  command.does([paths] { run_editor(*paths); });
}

}  // namespace rebake
