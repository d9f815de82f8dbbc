#pragma once

#include <deque>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rebake {

/// An option of a subcommand, as help shows it.
struct OptionHelp {
  std::string names;               ///< "-o,--out"; without a dash for a positional argument
  std::string hint;                ///< placeholder of the value, such as "OUT.png"; empty for a flag
  std::string help;                ///< one sentence
  std::vector<std::string> words;  ///< the only values allowed; empty if others are
};

/// A subcommand, as the manual page and shell completions show it.
struct SubcommandHelp {
  std::string name, help, footer;
  std::deque<OptionHelp> options;  ///< a deque, because descriptions hold references to its elements
};

/// Builder of a subcommand: declares its options and its function. Wraps CLI11, which is slow to compile and included
/// only by subcommand.cpp.
class SubcommandDescription {
 public:
  /// Adds to the parser `app`, and to `help`; both must outlive this object.
  SubcommandDescription(CLI::App& app, SubcommandHelp& help) : app_(&app), help_(&help) {}

  /// Constraints of an option's value; each function returns the option for chaining.
  class Option {
   public:
    Option(CLI::Option* option, OptionHelp& help) : option_(option), help_(&help) {}
    Option& required();
    Option& one_of(const std::vector<std::string>& words);
    Option& one_of(const std::vector<int>& numbers);
    Option& between(int least, int most);
    /// Refuses an empty value, such as an unset shell variable.
    Option& not_empty();

   private:
    CLI::Option* option_;
    OptionHelp* help_;
  };

  /// Adds an option that is stored in `value`. `names`: "-o,--out", or a name without dashes for a positional argument.
  /// `hint`: placeholder and default of the value in the help.
  template <class T>
  Option option(const std::string& names, T& value, const std::string& help, const std::string& hint);
  /// Adds an option without a value, which sets `value` to true.
  void flag(const std::string& names, bool& value, const std::string& help);
  /// Text after the options in the help.
  void footer(const std::string& text);
  /// Sets the function to run after the options are parsed.
  void does(std::function<void()> run);

 private:
  CLI::App* app_;
  SubcommandHelp* help_;
};

/// Entry of the table of subcommands (subcommands.h).
struct Subcommand {
  const char* name;
  const char* help;  ///< one line
  void (*describe)(SubcommandDescription& command);
};

/// Thrown by a subcommand that ran but whose answer is "no", to end the program with an exit code and without an error
/// message.
struct ExitWith {
  int code;  ///< 1 failed, 3 pictures differ, 4 below the requested quality
};

/// All subcommands with their options, in the order of the table.
std::vector<SubcommandHelp> subcommand_help();

/// The meaning of the program's exit codes, in sentences.
extern const char* const exit_code_help;

/// Parses the command line and runs the subcommand. Returns the exit code: 0, or 2 for a wrong command line. Throws
/// exceptions of the subcommand.
int run_program(int argc, char** argv);

}  // namespace rebake
