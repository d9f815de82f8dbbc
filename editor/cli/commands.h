#pragma once

#include "editor/cli/command.h"

namespace rebake {

void describe_edit(CommandDescription& command);
void describe_info(CommandDescription& command);
void describe_render(CommandDescription& command);
void describe_run(CommandDescription& command);
void describe_export(CommandDescription& command);
void describe_batch(CommandDescription& command);
void describe_recover(CommandDescription& command);
void describe_compare(CommandDescription& command);
void describe_study(CommandDescription& command);
void describe_light(CommandDescription& command);
void describe_completion(CommandDescription& command);

/// Table of all subcommands, in help order.
inline constexpr Subcommand subcommand_table[] = {
    {"edit", "opens the editor's window", describe_edit},
    {"info", "says what a folder or scene holds", describe_info},
    {"render", "draws one or several folders or scenes into a PNG", describe_render},
    {"run", "runs a script of edits and actions, one JSON object a line", describe_run},
    {"export", "writes a folder or scene in the MobileNeRF format", describe_export},
    {"batch", "runs one script on many scenes, each imported first as the node \"scene\" and exported at the end",
     describe_batch},
    {"recover", "gets the work of a run that was killed back from its journal, as a project", describe_recover},
    {"compare", "says how much two pictures differ", describe_compare},
    {"study", "measures accuracy against time: a table (CSV) and a plot (SVG, PNG)", describe_study},
    {"light", "learns how an object sees the sky in its poses, for light that goes along with drags", describe_light},
    {"completion", "prints shell completions or the manual page", describe_completion}};

}  // namespace rebake
