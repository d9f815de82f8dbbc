#include <fmt/format.h>

#include <memory>

#include "editor/cli/help_pages.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/version.h"

namespace rebake {

void describe_completion(SubcommandDescription& command) {
  const auto kind = std::make_shared<std::string>();
  command.option("kind", *kind, "shell whose completions to print, or man for the manual page", "bash|zsh|fish|man")
      .required()
      .one_of({"bash", "zsh", "fish", "man"});
  command.footer(
      "The Debian package installs all of them. To load them by hand:\n"
      "  bash  source <(rebake completion bash)\n"
      "  zsh   rebake completion zsh > \"${fpath[1]}/_rebake\"\n"
      "  fish  rebake completion fish > ~/.config/fish/completions/rebake.fish\n"
      "  man   rebake completion man | man -l -");
  command.does([kind] {
    const std::vector<SubcommandHelp> subcommands = subcommand_help();
    fmt::print("{}", *kind == "bash"   ? bash_completion(subcommands)
                     : *kind == "zsh"  ? zsh_completion(subcommands)
                     : *kind == "fish" ? fish_completion(subcommands)
                                       : manual_page(subcommands, program_version()));
  });
}

}  // namespace rebake
