#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <filesystem>
#include <new>

#include "editor/cli/commands.h"
#include "editor/cli/terminal.h"
#include "mesh_ops/error.h"

int main(int argc, char** argv) {
  CLI::App program{"Rebake: loads, composes, edits, renders and exports baked NeRF scenes (MobileNeRF format).",
                   "rebake"};
  program.set_version_flag("--version", "rebake " REBAKE_VERSION);
  program.require_subcommand(1);
  program.footer(
      "Exit codes: 0 done, 1 it could not be done (the message says why), 2 wrong use of the command line, 3 compared "
      "pictures differ more than allowed, 130 stopped by Ctrl+C.");
  for (const rebake::Subcommand& command : rebake::subcommand_table) command.add(program);
  // A full quota then fails a write, which is reported, instead of ending the program.
  std::signal(SIGXFSZ, SIG_IGN);
  rebake::stop_on_interrupt();
  const auto fail = [](const std::string& what) {
    rebake::clear_progress_bar();
    fmt::print(stderr, "{} {}\n", rebake::coloured("error:", "1;31"), what);
    return 1;
  };
  try {
    program.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const rebake::ExitWith& exit) {
    return exit.code;
  } catch (const rebake::FieldError& error) {
    fail(error.what());
    return 2;
  } catch (const rebake::Cancelled&) {
    fail("stopped; nothing was replaced");
    return 130;
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.path1().string() + ": " + error.code().message());
  } catch (const rebake::Error& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("memory is out");
  } catch (const std::exception& error) {
    return fail(std::string("unexpected: ") + error.what());
  }
}
