#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/cli/commands.h"
#include "editor/cli/options.h"
#include "editor/cli/terminal.h"
#include "editor/commands/export.h"
#include "editor/commands/session.h"
#include "editor/fields/codec.h"

namespace rebake {

void describe_export(CommandDescription& command) {
  struct Options {
    std::string folder, out, layout;
    std::string format = ExportAction().format;
    std::string axes = "360";
  };
  auto options = std::make_shared<Options>();
  command.option("folder", options->folder, "what to export", "FOLDER|SCENE").required();
  command.option("-o,--out", options->out, "folder to write; replaced whole or not at all", "FOLDER").required();
  command.option("--layout", options->layout, "convert the layout", "split|chunked|unsplit [as read]")
      .one_of(std::vector<std::string>{"split", "chunked", "unsplit"});
  command.option("--format", options->format, "what to write", "mobilenerf|rebake [mobilenerf]");
  add_axes_option(command, options->axes);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = say_line;
    Opened opened = read_all({options->folder}, options->axes, session.progress);
    session.document = Document(std::move(opened.scene));
    // What names the folders must stay as well as they.
    opened.sources.check_folder(options->out);
    std::error_code error;
    const bool replaces = std::filesystem::exists(options->out, error);
    ExportAction action;
    action.out = options->out;
    action.format = options->format;
    if (!options->layout.empty()) action.layout = Codec<Layout>::read(nlohmann::json(options->layout), session.scene());
    run(session, action);
    if (replaces) say_line("note: it took the place of the folder that was there");
  });
}

}  // namespace rebake
