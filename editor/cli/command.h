#pragma once

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

/// A subcommand while it is described: its options and what it does. The library that parses them is known to
/// command.cpp alone, which takes long to compile.
class CommandDescription {
 public:
  explicit CommandDescription(CLI::App& app) : app_(&app) {}

  /// What an option takes; each returns itself.
  class Option {
   public:
    explicit Option(CLI::Option* option) : option_(option) {}
    Option& required();
    Option& one_of(const std::vector<std::string>& words);
    Option& one_of(const std::vector<int>& numbers);
    Option& between(int least, int most);
    /// Refuses an empty text, such as a shell's variable that is not set.
    Option& not_empty();

   private:
    CLI::Option* option_;
  };

  /// `names` as "-o,--out", or a plain name for what stands without one. `hint` is shown in help for the value.
  template <class T>
  Option option(const std::string& names, T& value, const std::string& help, const std::string& hint);
  void flag(const std::string& names, bool& value, const std::string& help);
  /// Behind the options in help.
  void footer(const std::string& text);
  /// What it does, once the options are read.
  void does(std::function<void()> run);

 private:
  CLI::App* app_;
};

/// A subcommand: its name, what it is for, and its description.
struct Subcommand {
  const char* name;
  const char* help;
  void (*describe)(CommandDescription& command);
};

/// Thrown by a subcommand for a missing or wrong option that only it can tell; ends with exit code 2.
struct ExitWith {
  int code;  ///< what main is to return after a command that ran, but whose answer is "no" (compare below its bar)
};

/// Parses and runs; returns the exit code. Throws what the subcommand throws.
int run_program(int argc, char** argv);

}  // namespace rebake
