#pragma once

#include <gtest/gtest.h>

#include <string>

#include "editor/actions/session.h"
#include "editor/script/script.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {

/// Runs scripts in one session. `{here}` is a temporary folder with two generated scenes, `ball` and `other`.
class Script : public ::testing::Test {
 protected:
  Script() {
    export_scene(scene_of(made_object({.seed = 1})), folder_.path() / "ball", {});
    export_scene(scene_of(made_object({.seed = 2})), folder_.path() / "other", {});
  }
  Session session;
  void run(const std::string& text) { run_script(session, text, "s.jsonl", {{"here", folder_.path().string()}}); }
  std::string error_of(const std::string& text) {
    try {
      run(text);
    } catch (const ScriptError& error) {
      return error.what();
    }
    return "no error";
  }
  void expect_error(const std::string& text, const std::string& says) {
    const std::string error = error_of(text);
    EXPECT_NE(error.find(says), std::string::npos) << error;
  }
  NodePtr node(const std::string& name) const { return find(session.scene(), name); }
  std::size_t selected(const std::string& name) const {
    return node(name)->selection ? count(*node(name)->selection) : 0;
  }
  const std::string import = R"({"op": "import", "path": "{here}/ball", "as": "ball"})"
                             "\n";
  TemporaryFolder folder_;
};

}  // namespace rebake::test
