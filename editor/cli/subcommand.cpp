#include "editor/cli/subcommand.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/cli/version.h"

namespace rebake {

SubcommandDescription::Option& SubcommandDescription::Option::required() {
  option_->required();
  return *this;
}
SubcommandDescription::Option& SubcommandDescription::Option::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  help_->words = words;
  return *this;
}
SubcommandDescription::Option& SubcommandDescription::Option::one_of(const std::vector<int>& numbers) {
  option_->check(CLI::IsMember(numbers));
  for (const int number : numbers) help_->words.push_back(std::to_string(number));
  return *this;
}
SubcommandDescription::Option& SubcommandDescription::Option::not_empty() {
  option_->check(
      [](const std::string& text) { return text.empty() ? std::string("must not be empty") : std::string(); });
  return *this;
}
SubcommandDescription::Option& SubcommandDescription::Option::between(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

template <class T>
SubcommandDescription::Option SubcommandDescription::option(const std::string& names, T& value, const std::string& help,
                                                            const std::string& hint) {
  CLI::Option* added = app_->add_option(names, value, help);
  if (!hint.empty()) added->option_text(hint);
  return {added, help_->options.emplace_back(OptionHelp{names, hint, help, {}})};
}
template SubcommandDescription::Option SubcommandDescription::option(const std::string&, std::string&,
                                                                     const std::string&, const std::string&);
template SubcommandDescription::Option SubcommandDescription::option(const std::string&, int&, const std::string&,
                                                                     const std::string&);
template SubcommandDescription::Option SubcommandDescription::option(const std::string&, double&, const std::string&,
                                                                     const std::string&);
template SubcommandDescription::Option SubcommandDescription::option(const std::string&, std::optional<double>&,
                                                                     const std::string&, const std::string&);
template SubcommandDescription::Option SubcommandDescription::option(const std::string&, std::vector<std::string>&,
                                                                     const std::string&, const std::string&);

void SubcommandDescription::flag(const std::string& names, bool& value, const std::string& help) {
  app_->add_flag(names, value, help);
  help_->options.push_back({names, "", help, {}});
}
void SubcommandDescription::footer(const std::string& text) {
  app_->footer(text);
  help_->footer = text;
}
void SubcommandDescription::does(std::function<void()> run) { app_->callback(std::move(run)); }

namespace {

// Adds every subcommand to the parser.
std::vector<SubcommandHelp> describe_subcommands(CLI::App& program) {
  std::vector<SubcommandHelp> all;
  for (const Subcommand& subcommand : subcommand_table) {
    SubcommandHelp& help = all.emplace_back(SubcommandHelp{subcommand.name, subcommand.help, "", {}});
    SubcommandDescription command(*program.add_subcommand(subcommand.name, subcommand.help), help);
    subcommand.describe(command);
  }
  return all;
}

}  // namespace

const char* const exit_code_help =
    "Exit codes: 0 success, 1 error (see the message), 2 invalid command line, 3 compared "
    "pictures differ by more than allowed, 4 success, but below the requested quality, 130 stopped by a signal "
    "(Ctrl+C).";

std::vector<SubcommandHelp> subcommand_help() {
  CLI::App program{"", "rebake"};
  return describe_subcommands(program);
}

int run_program(int argc, char** argv) {
  CLI::App program{"Rebake edits, composes, renders and exports baked NeRF scenes (MobileNeRF format).", "rebake"};
  program.set_version_flag("--version", program_version());
  program.require_subcommand(1);
  program.footer(exit_code_help);
  describe_subcommands(program);
  try {
    program.parse(argc, argv);
    return 0;
  } catch (const CLI::RequiredError& error) {
    // CLI11 ignores a first word that is no subcommand.
    if (argc > 1 && argv[1][0] != '-' && program.get_subcommands().empty()) {
      write_stderr(fmt::format("error: there is no subcommand \"{}\"; rebake --help lists all\n", argv[1]));
      return 2;
    }
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
}

}  // namespace rebake
