#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {

/// Runs the program in a temporary folder, to see which files it refuses to replace.
class Guards : public ::testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) const { write_file_atomically(path(name), text, {}); }
  // A camera file and the photograph that it names, in "cap".
  void write_capture() const {
    std::filesystem::create_directories(path("cap/images"));
    write("cap/transforms.json", R"({"camera_angle_x": 0.7, "w": 16, "h": 16, "frames": [{"file_path": "images/0.png",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
    write("cap/images/0.png", "\x89PNG of somebody");
  }
  // Exit status of the program; {} in the arguments is replaced by the test's folder.
  int program(std::string arguments) const {
    for (std::size_t at = 0; (at = arguments.find("{}", at)) != std::string::npos;)
      arguments.replace(at, 2, folder_.path().string());
    const std::string command = fmt::format("'{}' {} >'{}' 2>&1", REBAKE_PROGRAM, arguments, path("log").string());
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string log() const { return read_file(path("log")); }
  std::string import_line() const {
    return fmt::format("{{\"op\": \"import\", \"path\": \"{}/samples/scenes/kettle\", \"as\": \"kettle\"}}\n",
                       REBAKE_SOURCE);
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace rebake::test
