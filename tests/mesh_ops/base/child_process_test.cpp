// Other programs that the window runs.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "mesh_ops/base/child_process.h"
#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

TEST(ChildProcess, ReadsAllOutputAndEndsWithItsOwner) {
  const auto ended = [](ChildProcess& child) {
    std::optional<int> status;
    while (!(status = child.ended())) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return *status;
  };
  const std::string shell = program_path("sh");
  ASSERT_FALSE(shell.empty());
  EXPECT_TRUE(program_path("no program is called so").empty());
  // More output than a pipe buffers, written before it is read.
  ChildProcess talks({shell, "-c", "head -c 200000 /dev/zero | tr '\\0' x; exit 3"});
  EXPECT_EQ(ended(talks), 3);
  EXPECT_EQ(talks.output(), std::string(200000, 'x'));
  ChildProcess killed({shell, "-c", "kill -9 $$"});
  EXPECT_EQ(ended(killed), 128 + 9);
  EXPECT_THROW(ChildProcess({"/nowhere/program"}), Error);
  const auto start = std::chrono::steady_clock::now();
  { ChildProcess sleeps({shell, "-c", "exec sleep 60"}); }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30))
      << "the destructor must not wait for the child";
}

}  // namespace
}  // namespace rebake::test
