// Signals end the program within a second at any time, and leave files complete.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class Signals : public ::testing::Test {
 protected:
  Signals() {
    export_scene(scene_of(made_object({.columns = 64, .rows = 32})), path("ball"), {});
    export_scene(scene_of(made_object({.seed = 2})), path("out"), {});
    before_ = folder_bytes(path("out"));
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  // Runs a script and sends a signal once `ready` holds, or after two seconds. Returns how long the program then lived.
  template <class Ready>
  std::chrono::duration<double> lives_after(int signal, const std::string& script, Ready ready) {
    write_file_atomically(path("s.jsonl"), script, {});
    const pid_t child = fork();
    if (child == 0) {
      const int log = ::open(path("log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
      ::dup2(log, 1);
      ::dup2(log, 2);
      const std::string file = path("s.jsonl");
      ::execl(REBAKE_PROGRAM, REBAKE_PROGRAM, "run", file.c_str(), static_cast<char*>(nullptr));
      ::_exit(99);
    }
    for (int k = 0; k < 200 && !ready(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ::kill(child, signal);
    const Clock::time_point sent = Clock::now();
    int status = 0;
    ::waitpid(child, &status, 0);
    ended_by_signal_ = WIFEXITED(status) && WEXITSTATUS(status) == 130;
    EXPECT_TRUE(ended_by_signal_ || status == 0) << read_file(path("log"));
    return Clock::now() - sent;
  }
  std::string import() const {
    return fmt::format("{{\"op\": \"import\", \"path\": \"{}\"}}\n", path("ball").string());
  }

  TemporaryFolder folder_;
  std::map<std::string, std::string> before_;
  bool ended_by_signal_ = false;  ///< whether the signal ended the last run, which otherwise had finished before
};

// Seconds until the end: one, plus the scheduling delays of a busy machine.
constexpr double longest_wait = 1.8;

TEST_F(Signals, EndWorkThatCannotBeCancelled) {
  // CGAL's alpha wrap does not check for cancellation.
  const std::string wrap =
      R"({"op": "cage", "node": "ball", "wrap": 0.008, "moves": [{"points": [0], "translate": [1, 0, 0]}]})";
  for (const int signal : {SIGTERM, SIGHUP}) {
    EXPECT_LE(lives_after(signal, import() + wrap, [] { return false; }).count(), longest_wait);
    EXPECT_TRUE(ended_by_signal_);
  }
}

TEST_F(Signals, KeepExportsCompleteAndRemoveTemporaryFiles) {
  const auto temporaries = [&] {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
      if (entry.path().filename().string().starts_with(".out")) return true;
    return false;
  };
  const std::string line = fmt::format("{{\"op\": \"export\", \"out\": \"{}\"}}\n", path("out").string());
  lives_after(SIGCONT, import() + line, [] { return true; });
  const auto exported = folder_bytes(path("out"));
  ASSERT_TRUE(exported != before_);
  // Signals at increasing delays after writing has begun: some before, some after the folder is in place.
  for (int k = 0; k < cases(6, 40); ++k) {
    export_scene(scene_of(made_object({.seed = 2})), path("out"), {});
    const auto ready = [&] {
      if (!temporaries()) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(3 * k));
      return true;
    };
    EXPECT_LE(lives_after(SIGTERM, import() + line, ready).count(), longest_wait);
    EXPECT_TRUE(folder_bytes(path("out")) == (ended_by_signal_ ? before_ : exported)) << k;
    EXPECT_FALSE(temporaries()) << k;
  }
}

}  // namespace
}  // namespace rebake::test
