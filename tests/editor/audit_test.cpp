// What a scene's light leaves out is never seen: the samples with every edit that moves, removes or adds something, at
// budgets from a small one to one that leaves nearly all out, against the same with all of it worked out.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/edits/edit.h"
#include "mesh_ops/light/lighting.h"
#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

using nlohmann::json;

struct InMemory final : Results {
  std::map<std::string, std::string> held;
  std::optional<std::string> find(const std::string& key) override {
    const auto it = held.find(key);
    return it == held.end() ? std::nullopt : std::optional(it->second);
  }
  void keep(const std::string& key, std::string_view bytes) override { held[key] = bytes; }
};

Scene with(Scene scene, const std::vector<json>& edits) {
  for (const json& line : edits) scene = apply(scene, read_edit(line, scene)).scene;
  return scene;
}

// The samples side by side, the kettle by the branch that hangs over.
Scene samples() {
  const auto import = [](const char* name) -> json {
    return {{"op", "import"}, {"path", std::string(REBAKE_SOURCE "/samples/scenes/") + name}};
  };
  return with({}, {import("ficus"),
                   import("kettle"),
                   {{"op", "transform"}, {"node", "kettle"}, {"translate", {0.9, -0.55, 0.3}}, {"scale", 0.7}}});
}

const json branch{{"min", {0.52, 0.5, 0}}, {"max", {1, 1, 1}}};

json bend(double degrees) {
  return {{"op", "bend"},  {"node", "ficus"},  {"degrees", degrees}, {"axis", {1, 0.3, 0}}, {"direction", {0, -1, 0}},
          {"box", branch}, {"frame", "bounds"}};
}
json erase(double radius) {
  return {{"op", "erase"}, {"node", "ficus"}, {"sphere", {{"center", {0.4, 0.4, 0}}, {"radius", radius}}}};
}
json move_kettle(double x) { return {{"op", "transform"}, {"node", "kettle"}, {"translate", {x, 0.2, 0}}}; }
json twist(double degrees) { return {{"op", "twist"}, {"node", "ficus"}, {"degrees", degrees}, {"axis", {0, 1, 0}}}; }
json select(const json& box) { return {{"op", "select"}, {"node", "ficus"}, {"box", box}, {"frame", "bounds"}}; }
const json remove_selected{{"op", "delete"}, {"node", "ficus"}};

struct Case {
  const char* name;
  std::vector<json> edits;
  bool leaves_out = false;  ///< something that is seen, at one of the budgets
  friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};
const Case edited_samples[] = {
    {"nothing", {}},
    {"beside", {move_kettle(-0.3)}},
    {"away", {move_kettle(12)}, true},
    {"far", {move_kettle(40)}, true},
    {"mirrored", {{{"op", "transform"}, {"node", "kettle"}, {"scale", {-1, 1, 1}}}, move_kettle(14)}, true},
    {"hide", {{{"op", "hide"}, {"node", "kettle"}}}},
    {"remove", {{{"op", "remove"}, {"node", "ficus"}}}},
    {"delete", {select(branch), remove_selected}},
    {"erase", {erase(0.3)}},
    {"delete_little", {select({{"min", {0, 0.97, 0}}, {"max", {1, 1, 1}}}), remove_selected, move_kettle(40)}, true},
    {"separate",
     {select(branch),
      {{"op", "separate"}, {"node", "ficus"}, {"as", "branch"}},
      {{"op", "transform"}, {"node", "branch"}, {"translate", {12, 0.4, 0}}},
      move_kettle(-12)},
     true},
    {"bend", {bend(5)}},
    {"bend_little", {bend(0.3), move_kettle(40)}, true},
    {"twist", {twist(50)}},
    {"twist_little", {twist(0.3), move_kettle(40)}, true},
    {"duplicate",
     {{{"op", "duplicate"}, {"node", "kettle"}, {"as", "second"}},
      {{"op", "transform"}, {"node", "second"}, {"translate", {-15, 0, 0.4}}}},
     true},
};

class Audit : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Samples, Audit, ::testing::ValuesIn(edited_samples),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST_P(Audit, WhatWasLeftOutStaysWithinItsBounds) {
  static InMemory results;  // what one case has traced another need not
  static Renderer renderer;
  static const Scene before = samples();
  const Scene edited = with(before, GetParam().edits);
  std::vector<View> views;
  for (const Vec3& from : {Vec3(2.5, 2, 3), Vec3(-3, 1, 1), Vec3(0.5, -1, -3.5)}) {
    View view;
    view.camera.eye = from;
    view.camera.target = {0.3, 0, 0};
    view.camera.near_plane = 0.2;
    view.camera.far_plane = 60;
    view.width = view.height = 160;
    view.samples = 4;
    views.push_back(view);
  }
  // Light's nodes far apart: bounds and light are of the same ones.
  LightingOptions options{.rays = 64, .spacing = 8, .most_nodes = 6000, .results = &results};
  double most_left_out = 0;
  for (const double budget : is_deep ? std::vector{1.0, 6.0, 40.0} : std::vector{6.0, 40.0}) {
    const Scene scene = with(edited, {{{"op", "light"}, {"source", "sky"}, {"budget", budget}}});
    options.everything = false;
    const Lighting planned = lighting_of(scene, options);
    options.everything = true;
    const Lighting everything = lighting_of(scene, options);
    EXPECT_EQ(everything.left_out, 0);
    EXPECT_LE(planned.left_out, budget / 255);
    most_left_out = std::max(most_left_out, planned.left_out);
    EXPECT_EQ(planned.decisions.size(), everything.decisions.size());
    for (const LightDecision& decision : planned.decisions) EXPECT_FALSE(decision.why.empty()) << decision.name;
    for (const View& view : views) {
      const Difference off =
          compare(renderer.render(scene, view, {}, &planned), renderer.render(scene, view, {}, &everything), 0);
      // Both pictures are rounded.
      EXPECT_LE(off.largest, planned.left_out * 255 + 1) << "budget " << budget << ", pixel " << off.x << ", " << off.y;
    }
  }
  EXPECT_EQ(most_left_out > 0, GetParam().leaves_out) << "the case does not test what it should";
}

}  // namespace
}  // namespace rebake::test
