#include "editor/actions/export_action.h"
#include "editor/cli/output_subcommand.h"
#include "editor/cli/subcommands.h"

namespace rebake {

void describe_export(SubcommandDescription& command) {
  describe_output<ExportAction>(command, "output folder, or NAME.glb with --format gltf; replaced atomically",
                                "FOLDER|FILE");
}

}  // namespace rebake
