#include <memory>

#include "editor/actions/export_action.h"
#include "editor/actions/output_state.h"
#include "editor/actions/session.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/edits/shape/refit.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void describe_refit(SubcommandDescription& command) {
  struct Options {
    std::string scene, out;
    Refit refit;
    FolderOptions reading;
  };
  auto options = std::make_shared<Options>();
  command.option("scene", options->scene, "scene: a folder, a mesh or a project", "FOLDER|SCENE|PROJECT").required();
  command
      .option("photographs", options->refit.path, "camera file of the photographs, or the folder of a capture",
              "CAMERAS")
      .required();
  command.option("-o,--out", options->out, "output folder; replaced atomically", "FOLDER").required();
  command.flag("--decoder", options->refit.decoder,
               "fit the decoders too; always for objects without view dependence, which then get one");
  command.flag("--gain", options->refit.gain, "photographs have different exposures");
  command.option("--epochs", options->refit.epochs, "with --decoder: passes over all texels", "N [40]")
      .between(1, 1000);
  options->reading.add_to(command);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = print_message;
    LoadedScene opened = load_scenes({options->scene}, options->reading, session.progress);
    opened.sources.check_folder(options->out);
    session.document = Document(std::move(opened.scene));
    session.document.protect_all(opened.sources);
    const OutputState before(options->out);
    session.edit(options->refit);
    if (before.has_other_content())
      throw FileError(options->out, "was written by something else during the fit, so it is not replaced");
    ExportAction action;
    action.out = options->out;
    run(session, action);
  });
}

}  // namespace rebake
