#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {

/// Result of a program.
struct ProgramResult {
  int code;
  std::string text;  // standard output and error
};

inline ProgramResult run_program(const std::string& program, const std::string& arguments) {
  FILE* pipe = popen((program + " " + arguments + " 2>&1").c_str(), "r");
  ProgramResult outcome{};
  char buffer[4096];
  while (const std::size_t got = std::fread(buffer, 1, sizeof buffer, pipe)) outcome.text.append(buffer, got);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return outcome;
}

inline ProgramResult rebake_run(const std::string& arguments, const std::string& before = "") {
  return run_program(before + " " + REBAKE_PROGRAM, arguments);
}

/// A folder "ball" to run the program on.
class Cli : public ::testing::Test {
 protected:
  Cli() { export_scene(scene_of(made_object()), folder_.path() / "ball", {}); }
  std::string in(const std::string& name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

}  // namespace rebake::test
