#include <CLI/CLI.hpp>
#include <memory>

#include "editor/cli/commands.h"
#include "editor/gui/editor_window.h"

namespace rebake {

void add_edit(CLI::App& program) {
  auto paths = std::make_shared<std::vector<std::string>>();
  CLI::App* command = program.add_subcommand("edit", "opens the editor's window");
  command->add_option("paths", *paths, "what to open: folders and scenes together, or one project")
      ->option_text("FOLDER|SCENE|PROJECT...");
  command->callback([paths] { run_editor(*paths); });
}

}  // namespace rebake
