#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "editor/document/document.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {

/// A temporary folder with a scene to import (sources/ball), and edits to test with.
class DocumentTest : public ::testing::Test {
 protected:
  DocumentTest() { export_scene(scene_of(made_object()), path("sources/ball"), {}); }
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  void act(Document& document, const nlohmann::json& edit) const { document.edit(read_edit(edit, document.scene())); }
  void act(Document& document, const char* edit) const { act(document, nlohmann::json::parse(edit)); }
  void import(Document& document) const {
    act(document, nlohmann::json{{"op", "import"}, {"path", path("sources/ball").string()}, {"as", "ball"}});
  }
  /// Seven edits: imports the ball, deletes half of it, separates half of the rest as "part", moves it, and erases
  /// texels.
  void work(Document& document) const {
    import(document);
    act(document,
        R"({"op": "select", "node": "ball", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})");
    act(document, R"({"op": "delete"})");
    act(document, R"({"op": "select", "box": {"min": [0, 0, 0], "max": [0.5, 1, 1]}, "frame": "bounds"})");
    act(document, R"({"op": "separate", "node": "ball", "as": "part"})");
    act(document, R"({"op": "transform", "node": "part", "translate": [3, 0, 0]})");
    act(document, R"({"op": "erase", "node": "part", "sphere": {"center": [2, 0, 0], "radius": 0.6}})");
  }
  std::map<std::string, std::string> exported(const Scene& scene) const {
    const TemporaryFolder out;
    export_scene(scene, out.path() / "out", {});
    return folder_bytes(out.path() / "out");
  }
  TemporaryFolder folder_;
};

}  // namespace rebake::test
