// Work that editors left behind, and the trash.
#include "editor/gui/state/lost_work.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/document/journal.h"
#include "editor/gui/state/settings.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class LostWorkFiles : public ::testing::Test {
 protected:
  LostWorkFiles() {
    ::setenv("XDG_STATE_HOME", home_.path().c_str(), 1);
    std::filesystem::create_directories(journal_folder());
  }
  // A journal with this many steps; returns its bytes.
  static std::string journal(int steps) {
    const std::vector<nlohmann::json> entries(static_cast<std::size_t>(steps),
                                              {{"edit", {{"op", "background"}, {"color", {0, 0, 1}}}}});
    Journal::create(journal_folder() / "J.journal", entries);
    return read_file(journal_folder() / "J.journal");
  }

 private:
  TemporaryFolder home_;
};

// Equal names arise when a backup of the state folder is put back.
TEST_F(LostWorkFiles, OfOneNameAreBothKept) {
  const std::string six = journal(6);
  discard(lost_work().at(0));
  const std::string two = journal(2);
  discard(lost_work().at(0));
  EXPECT_EQ(discarded_work().size(), 2U);
  const std::string three = journal(3);
  for (const LostWork& work : discarded_work()) restore(work);
  EXPECT_TRUE(discarded_work().empty());
  std::multiset<std::string> kept;
  for (const LostWork& work : lost_work()) kept.insert(read_file(work.journal));
  EXPECT_EQ(kept, (std::multiset<std::string>{six, two, three}));
}

}  // namespace
}  // namespace rebake::test
