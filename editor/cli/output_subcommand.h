#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/cli/field_options.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommand.h"
#include "editor/cli/terminal.h"

namespace rebake {

/// Describes a subcommand that opens a scene and runs the action T on it, with an option per field; `-o` is its field
/// `out`.
template <class T>
void describe_output(SubcommandDescription& command, const char* out_help, const char* out_hint) {
  struct Options {
    std::string folder, out;
    FolderOptions reading;
    FieldOptions fields;
  };
  auto options = std::make_shared<Options>();
  command.option("folder", options->folder, "scene: a folder, a mesh or a project", "FOLDER|SCENE|PROJECT").required();
  command.option("-o,--out", options->out, out_help, out_hint).required();
  options->fields.add_to(command, action_type<T>().fields(), {"out"});
  options->reading.add_to(command);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = print_message;
    LoadedScene opened = load_scenes({options->folder}, options->reading, session.progress);
    session.document = Document(std::move(opened.scene));
    // The sources include the scene or project file that refers to the source folders.
    session.document.protect_all(opened.sources);
    opened.sources.check_folder(options->out);
    nlohmann::json action = options->fields.object();
    action["out"] = options->out;
    run(session, read_action<T>(action, session.scene()));
    if (session.below_requested_psnr) throw ExitWith{4};
  });
}

}  // namespace rebake
