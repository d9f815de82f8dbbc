#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/session.h"
#include "editor/actions/train.h"
#include "editor/cli/field_options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"

namespace rebake {

void describe_train(SubcommandDescription& command) {
  struct Options {
    std::string photographs, out;
    FieldOptions fields;
  };
  auto options = std::make_shared<Options>();
  command
      .option("photographs", options->photographs, "camera file of the photographs, or the folder of a capture",
              "CAMERAS")
      .required();
  command.option("-o,--out", options->out, "folder to write; replaced atomically", "FOLDER").required();
  options->fields.add_to(command, action_type<TrainAction>().fields(), {"photographs", "out"});
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = print_message;
    nlohmann::json action = options->fields.object();
    action["photographs"] = options->photographs;
    action["out"] = options->out;
    run(session, read_action<TrainAction>(action, session.scene()));
  });
}

}  // namespace rebake
