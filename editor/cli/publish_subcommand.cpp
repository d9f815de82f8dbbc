#include "editor/actions/publish_action.h"
#include "editor/cli/output_subcommand.h"
#include "editor/cli/subcommands.h"

namespace rebake {

void describe_publish(SubcommandDescription& command) {
  describe_output<PublishAction>(command, "output folder, or NAME.html with --single-file; replaced atomically",
                                 "FOLDER|FILE");
}

}  // namespace rebake
