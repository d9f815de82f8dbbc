#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/publish_action.h"
#include "editor/cli/field_options.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"

namespace rebake {

void describe_publish(SubcommandDescription& command) {
  struct Options {
    std::string folder, out;
    FolderOptions reading;
    FieldOptions fields;
  };
  auto options = std::make_shared<Options>();
  command.option("folder", options->folder, "scene: a folder, a mesh or a project", "FOLDER|SCENE|PROJECT").required();
  command
      .option("-o,--out", options->out, "output folder, or NAME.html with --single-file; replaced atomically",
              "FOLDER|FILE")
      .required();
  options->fields.add_to(command, action_type<PublishAction>().fields(), {"out"});
  options->reading.add_to(command);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = print_message;
    LoadedScene opened = load_scenes({options->folder}, options->reading, session.progress);
    session.document = Document(std::move(opened.scene));
    // The sources include the scene or project file that refers to the source folders.
    opened.sources.check_folder(options->out);
    nlohmann::json action = options->fields.object();
    action["out"] = options->out;
    run(session, read_action<PublishAction>(action, session.scene()));
  });
}

}  // namespace rebake
