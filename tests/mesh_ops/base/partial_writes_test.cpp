// Abandoned writes remove temporary files and keep finished files. Each case runs in its own process.
#include "mesh_ops/base/partial_writes.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

// Runs `work` in a child process; returns its exit code, −1 if it crashed.
template <class Work>
int in_own_process(Work work) {
  const pid_t child = fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(PartialWrites, AbandonedFoldersKeepTheirTargets) {
  const TemporaryFolder temporary;
  const fs::path target = temporary.path() / "out";
  fs::create_directory(target);
  write_file_atomically(target / "kept", "old", {});
  EXPECT_EQ(in_own_process([&] {
              AtomicFolder out(target, {}, [](const fs::path&) {});
              out.write("a/new", "new");
              abandon_writes(std::chrono::milliseconds(100));
              // After abandon_writes(), neither commit() nor the destructor returns.
              std::thread([&] {
                out.commit();
                ::_exit(1);
              }).detach();
              std::this_thread::sleep_for(std::chrono::milliseconds(100));
              ::_exit(0);
              return 0;
            }),
            0);
  EXPECT_EQ(folder_bytes(target), (std::map<std::string, std::string>{{"kept", "old"}}));
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary.path()), {}), 1) << "no temporary folder is left";
}

TEST(PartialWrites, AbandonWaitsForCommits) {
  const TemporaryFolder temporary;
  const fs::path file = temporary.path() / "partial";
  EXPECT_EQ(in_own_process([&] {
              const PartialWrite known(file);
              write_file_atomically(file, "bytes", {});
              const auto committing = PartialWrite::committing();
              std::thread([] { abandon_writes(std::chrono::milliseconds(50)); }).join();
              return fs::exists(file) ? 0 : 1;
            }),
            0);
}

}  // namespace
}  // namespace rebake::test
