#include "editor/cli/command.h"

#include <CLI/CLI.hpp>

#include "editor/cli/commands.h"
#include "editor/cli/version.h"

namespace rebake {

CommandDescription::Option& CommandDescription::Option::required() {
  option_->required();
  return *this;
}
CommandDescription::Option& CommandDescription::Option::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  help_->words = words;
  return *this;
}
CommandDescription::Option& CommandDescription::Option::one_of(const std::vector<int>& numbers) {
  option_->check(CLI::IsMember(numbers));
  for (const int number : numbers) help_->words.push_back(std::to_string(number));
  return *this;
}
CommandDescription::Option& CommandDescription::Option::not_empty() {
  option_->check(
      [](const std::string& text) { return text.empty() ? std::string("must not be empty") : std::string(); });
  return *this;
}
CommandDescription::Option& CommandDescription::Option::between(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

template <class T>
CommandDescription::Option CommandDescription::option(const std::string& names, T& value, const std::string& help,
                                                      const std::string& hint) {
  CLI::Option* added = app_->add_option(names, value, help);
  if (!hint.empty()) added->option_text(hint);
  return {added, help_->options.emplace_back(OptionHelp{names, hint, help, {}})};
}
template CommandDescription::Option CommandDescription::option(const std::string&, std::string&, const std::string&,
                                                               const std::string&);
template CommandDescription::Option CommandDescription::option(const std::string&, int&, const std::string&,
                                                               const std::string&);
template CommandDescription::Option CommandDescription::option(const std::string&, double&, const std::string&,
                                                               const std::string&);
template CommandDescription::Option CommandDescription::option(const std::string&, std::optional<double>&,
                                                               const std::string&, const std::string&);
template CommandDescription::Option CommandDescription::option(const std::string&, std::vector<std::string>&,
                                                               const std::string&, const std::string&);

void CommandDescription::flag(const std::string& names, bool& value, const std::string& help) {
  app_->add_flag(names, value, help);
  help_->options.push_back({names, "", help, {}});
}
void CommandDescription::footer(const std::string& text) {
  app_->footer(text);
  help_->footer = text;
}
void CommandDescription::does(std::function<void()> run) { app_->callback(std::move(run)); }

namespace {

// Adds every subcommand to the parser.
std::vector<SubcommandHelp> describe_subcommands(CLI::App& program) {
  std::vector<SubcommandHelp> all;
  for (const Subcommand& subcommand : subcommand_table) {
    SubcommandHelp& help = all.emplace_back(SubcommandHelp{subcommand.name, subcommand.help, "", {}});
    CommandDescription command(*program.add_subcommand(subcommand.name, subcommand.help), help);
    subcommand.describe(command);
  }
  return all;
}

}  // namespace

const char* const exit_code_help =
    "Exit codes: 0 done, 1 it could not be done (the message says why), 2 wrong use of the command line, 3 compared "
    "pictures differ more than allowed, 4 done, but below the quality that was asked for, 130 stopped by a signal "
    "(Ctrl+C).";

std::vector<SubcommandHelp> subcommand_help() {
  CLI::App program{"", "rebake"};
  return describe_subcommands(program);
}

int run_program(int argc, char** argv) {
  CLI::App program{"Rebake: loads, composes, edits, renders and exports baked NeRF scenes (MobileNeRF format).",
                   "rebake"};
  program.set_version_flag("--version", program_version());
  program.require_subcommand(1);
  program.footer(exit_code_help);
  describe_subcommands(program);
  try {
    program.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
}

}  // namespace rebake
