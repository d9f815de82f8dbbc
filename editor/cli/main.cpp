#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>

#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/document/result_store.h"
#include "mesh_ops/base/error.h"

namespace {

// If a standard stream is closed, the next opened file would get its descriptor and receive messages.
void open_standard_streams() {
  for (int number = 0; number <= 2; ++number)
    if (::fcntl(number, F_GETFD) < 0) ::open("/dev/null", number == 0 ? O_RDONLY : O_WRONLY);
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  // A write beyond the file size limit then fails with an error instead of killing the process.
  std::signal(SIGXFSZ, SIG_IGN);
  rebake::stop_on_interrupt();
  rebake::set_result_cache(rebake::ResultStore::user_store());
  const auto fail = [](const std::string& what) {
    rebake::clear_progress_bar();
    rebake::write_stderr(rebake::coloured("error:", "1;31") + " " + rebake::printable(what) + "\n");
    return 1;
  };
  try {
    const int code = rebake::run_program(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return fail("standard output cannot be written; the result is lost");
    return code;
  } catch (const rebake::ExitWith& exit) {
    return exit.code;
  } catch (const rebake::FieldError& error) {
    fail(error.what());
    return 2;
  } catch (const rebake::Cancelled&) {
    fail("stopped; the output that was being written is as it was before");
    return 130;
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.path1().string() + ": " + error.code().message());
  } catch (const rebake::Error& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory");
  } catch (const std::exception& error) {
    return fail(std::string("unexpected error: ") + error.what());
  }
}
