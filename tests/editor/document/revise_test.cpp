// Document::revise(), steps that refine the step before: undo, redo, journals and projects keep each of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "editor/document/document.h"
#include "editor/gui/state/titles.h"
#include "tests/support/document_fixture.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

class Revise : public DocumentTest {
 protected:
  // A cage around the ball whose corner `point` is moved by `x`.
  static CageDeform moved(const Document& document, int point, double x) {
    const std::string line = fmt::format(
        R"({{"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{{"points": [{}], "translate": [{}, 0, 0]}}]}})",
        point, x);
    return *read_edit(nlohmann::json::parse(line), document.scene()).as<CageDeform>();
  }
};

TEST_F(Revise, AppliesToTheSceneBeforeTheRevisedStep) {
  Document document, direct;
  import(document);
  import(direct);
  const Scene rest = document.scene();
  document.edit(moved(document, 0, 0.1));
  document.revise({moved(document, 0, 0.5)});
  direct.edit(moved(direct, 0, 0.5));
  EXPECT_TRUE(exported(document.scene()) == exported(direct.scene()));
  EXPECT_EQ(document.history().edits().size(), 2U) << "scripts contain the last revision only";
  EXPECT_TRUE(document.undo_step());
  EXPECT_NE(document.scene().roots, rest.roots) << "undo must return to the first drag";
  EXPECT_TRUE(document.undo_step());
  EXPECT_EQ(document.scene().roots, rest.roots);
  EXPECT_TRUE(document.redo_step());
  EXPECT_TRUE(document.redo_step());
  EXPECT_TRUE(exported(document.scene()) == exported(direct.scene()));
}

TEST_F(Revise, RandomStepsSurviveUndoRecoveryAndEviction) {
  // Compared with a list of exported scenes for the same steps.
  std::mt19937 random(7);
  for (int round = 0; round < cases(3, 30); ++round) {
    Document document({}, round % 2 == 0 ? 1 : History::default_budget);
    const auto journal = path("journal" + std::to_string(round));
    document.keep_journal(journal);
    import(document);
    std::vector<std::map<std::string, std::string>> after{{}, exported(document.scene())};
    std::size_t at = 1;
    bool deformed = false;
    for (int k = 0; k < 14; ++k) {
      const int choice = static_cast<int>(random() % 6);
      const int point = static_cast<int>(random() % 8);
      const double x = static_cast<double>(random() % 9 + 1) / 20;
      if (choice == 0 && at > 1) {
        ASSERT_TRUE(document.undo_step());
        --at;
      } else if (choice == 1 && at + 1 < after.size()) {
        ASSERT_TRUE(document.redo_step());
        ++at;
      } else {
        const CageDeform* last = document.history().edits().back().as<CageDeform>();
        if (choice > 2 && last != nullptr)
          document.revise({moved(document, point, x)});
        else if (choice == 2 && last != nullptr)
          document.adjust({moved(document, point, x)});
        else
          document.edit(moved(document, point, x));
        after.resize(choice == 2 && last != nullptr ? at : at + 1);
        after.push_back(exported(document.scene()));
        at = after.size() - 1;
        deformed = true;
      }
      ASSERT_TRUE(exported(document.scene()) == after[at]) << "round " << round << ", step " << k;
    }
    ASSERT_TRUE(deformed);
    document.save(path("p.rebake"), {}, Document::OtherProject::replace);
    Document opened = Document::open(path("p.rebake"));
    for (std::size_t k = at; k > 0; --k) {
      EXPECT_TRUE(exported(opened.scene()) == after[k]) << "a project keeps every step";
      ASSERT_TRUE(opened.undo_step());
    }
    document = Document();
    Document recovered = std::move(Document::recover(journal).document);
    for (std::size_t k = at; k > 0; --k) {
      EXPECT_TRUE(exported(recovered.scene()) == after[k]) << "a journal keeps every step";
      ASSERT_TRUE(recovered.undo_step());
    }
    for (std::size_t k = 1; k < after.size(); ++k) {
      ASSERT_TRUE(recovered.redo_step());
      EXPECT_TRUE(exported(recovered.scene()) == after[k]);
    }
  }
}

TEST_F(Revise, TitlesCountMovedPoints) {
  Document document;
  import(document);
  const Scene rest = document.scene();
  const Edit first = moved(document, 0, 0.1);
  document.edit(first);
  EXPECT_EQ(title_of({first}, rest, document.scene()), "Moved 1 cage point of ball");
  CageDeform more = moved(document, 0, 0.1);
  more.moves.push_back(moved(document, 3, 0.2).moves.front());
  more.moves.push_back(moved(document, 5, 0.2).moves.front());
  const Scene before = document.scene();
  document.revise({more});
  EXPECT_EQ(title_of({more}, before, document.scene(), &first), "Moved 2 cage points of ball");
}

TEST_F(Revise, TitlesCountTrianglesOfChangedNodes) {
  Document document;
  import(document);
  act(document, R"({"op": "duplicate", "node": "ball", "as": "other"})");
  act(document, R"({"op": "select", "all": true})");
  const Scene both = document.scene();
  const Edit one = read_edit({{"op", "delete"}, {"node", "other"}}, both);
  document.edit(one);
  EXPECT_EQ(title_of({one}, both, document.scene()), "Deleted 256 triangles of other");
  const Scene left = document.scene();
  const Edit move = read_edit({{"op", "transform"}, {"node", "ball"}, {"selection", true}, {"translate", {1, 0, 0}}},
                              document.scene());
  document.edit(move);
  EXPECT_EQ(title_of({move}, left, document.scene()), "Moved 256 triangles of ball");
}

}  // namespace
}  // namespace rebake::test
