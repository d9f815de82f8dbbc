#pragma once

#include "editor/cli/subcommand.h"

namespace rebake {

void describe_edit(SubcommandDescription& command);
void describe_info(SubcommandDescription& command);
void describe_render(SubcommandDescription& command);
void describe_run(SubcommandDescription& command);
void describe_export(SubcommandDescription& command);
void describe_publish(SubcommandDescription& command);
void describe_refit(SubcommandDescription& command);
void describe_train(SubcommandDescription& command);
void describe_repair(SubcommandDescription& command);
void describe_batch(SubcommandDescription& command);
void describe_recover(SubcommandDescription& command);
void describe_compare(SubcommandDescription& command);
void describe_study(SubcommandDescription& command);
void describe_light(SubcommandDescription& command);
void describe_completion(SubcommandDescription& command);

/// Table of all subcommands, in help order.
inline constexpr Subcommand subcommand_table[] = {
    {"edit", "opens the editor window", describe_edit},
    {"info", "prints the contents of a folder or scene", describe_info},
    {"render", "renders folders or scenes to a picture file", describe_render},
    {"run", "runs a script of edits and actions (one JSON object per line)", describe_run},
    {"export", "exports a scene as a MobileNeRF folder, or in another format", describe_export},
    {"publish", "publishes a scene as a web page", describe_publish},
    {"train", "trains a scene from photographs with known cameras", describe_train},
    {"refit", "fits a scene's colours to photographs", describe_refit},
    {"repair", "writes a folder that other tools have changed as other programs expect it", describe_repair},
    {"batch", "runs one script on many scenes; each is imported as the node \"scene\" and exported at the end",
     describe_batch},
    {"recover", "recovers the edits of a crashed run from its journal, as a project", describe_recover},
    {"compare",
     "compares two pictures (PSNR, SSIM, largest difference), or a scene with photographs (PSNR, SSIM, FLIP)",
     describe_compare},
    {"study", "measures accuracy against time; writes a table (CSV) and a plot (SVG, PNG)", describe_study},
    {"light", "trains a model of an object's light transfer, for shading during drags", describe_light},
    {"completion", "prints shell completions or the manual page", describe_completion}};

}  // namespace rebake
