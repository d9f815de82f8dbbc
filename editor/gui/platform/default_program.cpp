#include "editor/gui/platform/default_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

extern char** environ;

namespace rebake {

void open_in_default_program(const std::filesystem::path& file) {
  std::string program = "xdg-open", path = std::filesystem::absolute(file).string();
  char* arguments[] = {program.data(), path.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_RDWR, 0);
  pid_t process = 0;
  const bool started = posix_spawnp(&process, program.c_str(), &quiet, nullptr, arguments, environ) == 0;
  posix_spawn_file_actions_destroy(&quiet);
  // It may run as long as the other program.
  if (started) std::thread([process] { ::waitpid(process, nullptr, 0); }).detach();
}

}  // namespace rebake
