#pragma once

namespace CLI {
class App;
}

namespace rebake {

/// A subcommand: adds itself, its options and what it does to the program.
struct Subcommand {
  void (*add)(CLI::App& program);
};

void add_info(CLI::App& program);
void add_render(CLI::App& program);
void add_edit(CLI::App& program);
void add_run(CLI::App& program);
void add_export(CLI::App& program);
void add_batch(CLI::App& program);
void add_recover(CLI::App& program);
void add_compare(CLI::App& program);
void add_study(CLI::App& program);

/// The one table of subcommands, in the order of help.
inline constexpr Subcommand subcommand_table[] = {{add_edit},  {add_info},    {add_render},  {add_run},  {add_export},
                                                  {add_batch}, {add_recover}, {add_compare}, {add_study}};

/// Says what main is to return after a command that ran, but whose answer is "no" (compare below its bar).
struct ExitWith {
  int code;
};

}  // namespace rebake
