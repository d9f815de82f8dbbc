#pragma once

#include <string>
#include <vector>

#include "editor/cli/subcommand.h"

namespace rebake {

/// The manual page in troff's man macros; `version` goes to its foot.
std::string manual_page(const std::vector<SubcommandHelp>& subcommands, const std::string& version);

/// Completion scripts: subcommands, then their options, the words that an option allows, and file names.
std::string bash_completion(const std::vector<SubcommandHelp>& subcommands);
std::string zsh_completion(const std::vector<SubcommandHelp>& subcommands);
std::string fish_completion(const std::vector<SubcommandHelp>& subcommands);

}  // namespace rebake
