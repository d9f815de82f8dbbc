#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <new>

#include "editor/cli/commands.h"
#include "editor/cli/terminal.h"
#include "editor/document/result_store.h"
#include "mesh_ops/base/error.h"

int main(int argc, char** argv) {
  // A full quota then fails a write, which is reported, instead of ending the program.
  std::signal(SIGXFSZ, SIG_IGN);
  rebake::stop_on_interrupt();
  rebake::keep_results_in(rebake::ResultStore::of_user());
  const auto fail = [](const std::string& what) {
    rebake::clear_progress_bar();
    fmt::print(stderr, "{} {}\n", rebake::coloured("error:", "1;31"), rebake::printable(what));
    return 1;
  };
  try {
    return rebake::run_program(argc, argv);
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
