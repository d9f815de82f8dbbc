// Audit of omitted light effects: the samples with every edit that moves, removes or adds something, at budgets from
// small to very large, compared with all effects computed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "editor/edits/edit.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/light/lighting.h"
#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

using nlohmann::json;

struct InMemoryResults final : ResultCache {
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

// Both samples, with the kettle next to the overhanging branch of the ficus.
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
  bool leaves_out = false;  ///< whether a visible effect is omitted at one of the budgets
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

View view_from(const Vec3& eye) {
  View view;
  view.camera.eye = eye;
  view.camera.target = {0.3, 0, 0};
  view.camera.near_plane = 0.2;
  view.camera.far_plane = 60;
  view.width = view.height = 160;
  view.samples = 4;
  return view;
}

// Compares pictures with the effects planned for `budget` (in 1/255) with pictures of all effects. Returns the sum of
// the bounds of omitted effects, in display colours 0 … 1.
double left_out_within_bounds(const Scene& edited, double budget, const std::vector<View>& views) {
  static InMemoryResults results;  // cache of traced light, shared by all cases
  static Renderer renderer;
  // A coarse light chart, for speed; bounds and light use the same nodes.
  LightingOptions options{.rays = 64, .spacing = 8, .max_nodes = 6000, .results = &results};
  const Scene scene = with(edited, {{{"op", "light"}, {"source", "sky"}, {"budget", budget}}});
  const Lighting planned = lighting_of(scene, options);
  options.everything = true;
  const Lighting everything = lighting_of(scene, options);
  EXPECT_EQ(everything.left_out, 0);
  EXPECT_LE(planned.left_out, budget / 255);
  EXPECT_EQ(planned.decisions.size(), everything.decisions.size());
  for (const LightDecision& decision : planned.decisions) EXPECT_FALSE(decision.why.empty()) << decision.name;
  RenderOptions all;
  all.everything = true;
  for (const View& view : views) {
    // 1/255 more, because both pictures are rounded.
    const double allowed = (planned.left_out + plan(scene, view, {}, nullptr, &planned).left_out) * 255 + 1;
    const Difference off = compare(renderer.render(scene, view, {}, &planned),
                                   renderer.render(scene, view, all, &everything), static_cast<int>(allowed));
    EXPECT_LE(off.share_beyond, planned.estimated ? Lighting::max_beyond : 0)
        << "budget " << budget << ", pixel " << off.x << ", " << off.y << ": " << off.largest << " of " << allowed;
  }
  return planned.left_out;
}

class Audit : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Samples, Audit, ::testing::ValuesIn(edited_samples),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST_P(Audit, OmittedEffectsStayWithinBounds) {
  static const Scene before = samples();
  const Scene edited = with(before, GetParam().edits);
  const std::vector<View> views{view_from({2.5, 2, 3}), view_from({-3, 1, 1}), view_from({0.5, -1, -3.5})};
  double max_left_out = 0;
  for (const double budget : is_deep ? std::vector{1.0, 6.0, 40.0} : std::vector{6.0, 40.0})
    max_left_out = std::max(max_left_out, left_out_within_bounds(edited, budget, views));
  EXPECT_EQ(max_left_out > 0, GetParam().leaves_out) << "this case must omit an effect if and only if it is marked so";
}

// Random scenes for the audit: one sample or both, with one to four edits that move, remove or add something.
class RandomScript {
 public:
  explicit RandomScript(unsigned seed) : random_(seed) {}

  Scene scene() {
    static const Scene both = samples(), ficus = with(both, {{{"op", "remove"}, {"node", "kettle"}}}),
                       kettle = with(both, {{{"op", "remove"}, {"node", "ficus"}}});
    Scene scene = std::array{both, ficus, kettle}[random_() % 3];
    for (std::size_t edits = 1 + random_() % 4; edits > 0; --edits) {
      const std::vector<json> lines = edit();
      try {
        scene = with(scene, lines);
        said_ += json(lines).dump() + "\n";
      } catch (const Error&) {
        // The node does not exist, or the region is empty.
      }
    }
    return scene;
  }
  double budget() { return std::exp(number(0, std::log(40))); }
  View view() { return view_from(3.5 * Vec3(number(-1, 1), number(-0.5, 1), number(-1, 1)).normalized()); }
  const std::string& said() const { return said_; }

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::vector<json> edit() {
    const char* const node = random_() % 2 == 0 ? "ficus" : "kettle";
    const json box{{"min", {number(0, 0.7), number(0, 0.7), number(0, 0.7)}}, {"max", {1, 1, 1}}};
    const double degrees = std::exp(number(std::log(0.1), std::log(60)));
    const json sphere{{"center", {number(-0.6, 0.6), number(-0.6, 0.6), 0}}, {"radius", number(0.05, 0.4)}};
    const json chosen{{"op", "select"}, {"node", node}, {"box", box}, {"frame", "bounds"}};
    switch (random_() % 7) {
      case 0:
        return {{{"op", "bend"},
                 {"node", node},
                 {"degrees", degrees},
                 {"axis", {1, number(-1, 1), 0}},
                 {"direction", {0, -1, 0}},
                 {"box", box},
                 {"frame", "bounds"}}};
      case 1:
        return {{{"op", "twist"}, {"node", node}, {"degrees", degrees}, {"axis", {0, 1, 0}}}};
      case 2:
        return {{{"op", "erase"}, {"node", node}, {"sphere", sphere}}};
      case 3:
        return {chosen, {{"op", "delete"}, {"node", node}}};
      case 4:
        return {{{"op", "transform"},
                 {"node", node},
                 {"translate", {number(-20, 20), number(-1, 1), 0}},
                 {"scale", number(0.3, 1.5)}}};
      case 5:
        return {chosen,
                {{"op", "separate"}, {"node", node}, {"as", "part"}},
                {{"op", "transform"}, {"node", "part"}, {"translate", {number(-9, 9), 0.4, 0}}}};
      default:
        return {{{"op", "duplicate"}, {"node", node}, {"as", "second"}},
                {{"op", "transform"}, {"node", "second"}, {"translate", {number(-9, 9), 0, 0.4}}}};
    }
  }

  std::mt19937 random_;
  std::string said_;
};

TEST(RandomAudit, OmittedEffectsStayWithinBounds) {
  int left_out = 0;
  for (int seed = 1; seed <= cases(3, 60); ++seed) {
    RandomScript script(static_cast<unsigned>(seed));
    const Scene scene = script.scene();
    SCOPED_TRACE("seed " + std::to_string(seed) + ":\n" + script.said());
    const double budget = script.budget();
    left_out += left_out_within_bounds(scene, budget, {script.view(), script.view()}) > 0 ? 1 : 0;
  }
  if (is_deep) {
    EXPECT_GT(left_out, 6) << "too few scripts omit an effect";
  }
}

}  // namespace
}  // namespace rebake::test
