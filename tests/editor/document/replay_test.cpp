// Replay gives the same bytes: random sessions of transforms, bends, twists and cages, repeated as a script, from the
// journal and from the project.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "editor/actions/session.h"
#include "editor/document/document.h"
#include "editor/fields/codec.h"
#include "editor/script/script.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;

Eigen::Quaterniond random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random), normal(random)};
}

TEST(Rotation, NormalisesOnceAndRoundTripsBitExactly) {
  std::mt19937 random(7);
  for (int k = 0; k < 20000; ++k) {
    Eigen::Quaterniond raw = random_turn(random);
    raw.coeffs() *= std::pow(10.0, static_cast<double>(k % 601) - 300);
    const Rotation made(raw);
    EXPECT_NEAR(made.quaternion().norm(), 1, 1e-15);
    const Rotation read = Codec<Rotation>::read(json::parse(Codec<Rotation>::write(made).dump()), {});
    ASSERT_EQ(read.quaternion().coeffs(), made.quaternion().coeffs()) << k;
    ASSERT_EQ(read.matrix(), made.matrix());
  }
  EXPECT_THROW(Rotation(Eigen::Quaterniond(0, 0, 0, 0)), Error);
  EXPECT_THROW(Rotation(Eigen::Quaterniond(1, 0, 0, std::nan(""))), Error);
  EXPECT_EQ(Rotation(Eigen::Quaterniond(1e200, 0, 0, 0)).quaternion().w(), 1);
  EXPECT_EQ(Rotation(Eigen::Quaterniond(1e-300, 0, 0, 0)).quaternion().w(), 1);
}

std::map<std::string, std::string> exported(const Scene& scene) {
  const TemporaryFolder out;
  export_scene(scene, out.path() / "out", {});
  return folder_bytes(out.path() / "out");
}

// A random edit with numbers of full precision, as drags in the window make them.
Edit random_edit(std::mt19937& random, const Scene& scene) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<NodeId> objects;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object) objects.push_back(placed.node->id);
  const NodeRef node{objects[random() % objects.size()]};
  switch (random() % 6) {
    case 0: {
      Transform edit;
      edit.node = node;
      edit.rotate = Rotation(random_turn(random));
      edit.translate = Vec3(unit(random), unit(random), unit(random));
      edit.scale.value = Vec3(1.1, 0.9, 1) + 0.1 * Vec3(unit(random), unit(random), unit(random));
      edit.scale_axes = Rotation(random_turn(random));
      return edit;
    }
    case 1: {
      Select edit;
      edit.node = node;
      edit.half_space = HalfSpaceRegion{Vec3(0.5, 0.5, 0.5), Vec3(unit(random), unit(random), 2)};
      edit.frame = CoordinateFrame::bounds;
      return edit;
    }
    case 2: {
      Bend edit;
      edit.target.node = node;
      edit.degrees = 60 * unit(random);
      edit.axis.axis = Vec3(unit(random), 1, unit(random));
      return edit;
    }
    case 3: {
      CageDeform edit;
      edit.target.node = node;
      edit.cage.lattice = {2, 1, 1};
      CageMove move;
      move.points.ranges = {{0, 1}};
      move.rotate = Rotation(random_turn(random));
      move.translate = 0.1 * Vec3(unit(random), unit(random), unit(random));
      edit.moves = {move};
      return edit;
    }
    case 4: {
      Twist edit;
      edit.target.node = node;
      edit.degrees = 90 * unit(random);
      return edit;
    }
    default: {
      Transform edit;
      edit.node = node;
      edit.selection = true;
      edit.rotate = Rotation(Eigen::AngleAxisd(unit(random), Vec3(unit(random), 1, unit(random)).normalized()));
      return edit;
    }
  }
}

TEST(Replay, ScriptJournalAndProjectGiveTheSameBytes) {
  const TemporaryFolder folder;
  const auto at = [&](const std::string& name) { return folder.path() / name; };
  export_scene(scene_of(made_object({.columns = 8, .rows = 6})), at("ball"), {});
  for (unsigned seed = 0; seed < 4; ++seed) {
    std::mt19937 random(seed);
    const auto journal = at(fmt::format("journal{}", seed)), project = at(fmt::format("p{}.rebake", seed));
    std::string script;
    std::map<std::string, std::string> bytes;
    {
      Session session;
      session.document.keep_journal(journal);
      Import import;
      import.path = at("ball").string();
      session.edit(import);
      int done = 0;
      while (done < 20) {
        try {
          session.edit(random_edit(random, session.scene()));
          ++done;
        } catch (const Error&) {
          ++done;  // nothing selected yet, or too strongly deformed for a cage
        }
      }
      ASSERT_GT(session.document.history().undo_count(), 10U);
      session.document.save(project);
      for (const Edit& edit : session.document.history().edits()) script += to_json(edit).dump() + "\n";
      bytes = exported(session.scene());
    }
    Session again;
    run_script(again, script, "script", {});
    EXPECT_EQ(exported(again.scene()), bytes) << "script, seed " << seed;
    EXPECT_EQ(exported(Document::open(project).scene()), bytes) << "project, seed " << seed;
    EXPECT_EQ(exported(Document::recover(journal).document.scene()), bytes) << "journal, seed " << seed;
  }
}

// An edit that no file can store, such as one with NaN, is rejected before it is applied.
TEST(Replay, RejectsUnreadableEdits) {
  const TemporaryFolder folder;
  export_scene(scene_of(made_object({.columns = 4, .rows = 2})), folder.path() / "ball", {});
  Document document;
  Import import;
  import.path = (folder.path() / "ball").string();
  document.edit(import);
  Transform edit;
  edit.node = NodeRef{document.scene().roots[0]->id};
  edit.translate = Vec3(std::nan(""), 0, 0);
  EXPECT_THROW(document.edit(edit), Error);
  EXPECT_EQ(document.history().undo_count(), 1U);
}

}  // namespace
}  // namespace rebake::test
