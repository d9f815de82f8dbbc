#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "editor/actions/export.h"
#include "editor/cli/commands.h"
#include "editor/cli/options.h"
#include "editor/cli/terminal.h"

namespace rebake {

void add_export(CLI::App& program) {
  struct Options {
    std::string folder, out, layout;
    Axes axes = Axes::y_up;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("export", "writes a folder or scene in the MobileNeRF format");
  command->add_option("folder", options->folder, "what to export")->required()->option_text("FOLDER|SCENE");
  command->add_option("-o,--out", options->out, "folder to write; replaced whole or not at all")
      ->required()
      ->option_text("FOLDER");
  command->add_option("--layout", options->layout, "convert the layout")
      ->check(CLI::IsMember({"split", "chunked", "unsplit"}))
      ->option_text("split|chunked|unsplit [as read]");
  add_axes_option(*command, options->axes);
  command->callback([options] {
    Session session;
    session.progress = progress_bar();
    session.say = [](const std::string& line) {
      clear_progress_bar();
      fmt::print(stderr, "{}\n", line);
    };
    session.document = Document(read_all({options->folder}, options->axes, session.progress));
    ExportAction action;
    action.out = options->out;
    if (!options->layout.empty()) action.layout = Codec<Layout>::read(options->layout, session.scene());
    run(session, action);
  });
}

}  // namespace rebake
