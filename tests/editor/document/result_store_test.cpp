// ResultStore, the cache of expensive results on disk: lookup, damage, eviction, unwritable folders.
#include "editor/document/result_store.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "mesh_ops/base/files.h"
#include "tests/support/document_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
  std::error_code error;
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder, error), fs::directory_iterator()));
}

TEST(ResultStore, FindsStoredResultsOnly) {
  const TemporaryFolder folder;
  ResultStore store(folder.path() / "deep/er");
  EXPECT_FALSE(store.find("wrap1-1"));
  const std::string bytes("a\0b\n", 4);
  store.keep("wrap1-1", bytes);
  EXPECT_EQ(store.find("wrap1-1"), bytes);
  EXPECT_EQ(ResultStore(folder.path() / "deep/er").find("wrap1-1"), bytes) << "another run";
  EXPECT_FALSE(store.find("wrap1-2"));
  EXPECT_NE(result_key("wrap1", "x"), result_key("wrap1", "y"));
  EXPECT_NE(result_key("wrap1", "x"), result_key("wrap2", "x"));
}

TEST(ResultStore, IgnoresAndRemovesDamagedFiles) {
  const TemporaryFolder folder;
  ResultStore store(folder.path());
  store.keep("k", "some bytes");
  const fs::path file = fs::directory_iterator(folder.path())->path();
  std::string bytes = read_file(file);
  bytes.back() ^= 1;
  write_file_atomically(file, bytes, {});
  EXPECT_FALSE(store.find("k"));
  EXPECT_FALSE(fs::exists(file));
  store.keep("k", "some bytes");
  std::ofstream(file, std::ios::binary | std::ios::trunc) << "short";
  EXPECT_FALSE(store.find("k"));
}

// A key of result_key() for a name.
std::string key(const std::string& name) { return result_key("kind", name); }

TEST(ResultStore, EvictsLeastRecentlyUsedWithinLimit) {
  const TemporaryFolder folder;
  ResultStore store(folder.path(), 300);
  const std::string block(80, 'x');  // 96 bytes on the disk
  const auto age = [&](const std::string& name, int minutes) {
    fs::last_write_time(folder.path() / (key(name) + ".result"),
                        fs::file_time_type::clock::now() - std::chrono::minutes(minutes));
  };
  for (const char* name : {"a", "b", "c"}) store.keep(key(name), block);
  age("a", 3);
  age("b", 2);
  age("c", 1);
  EXPECT_TRUE(store.find(key("a")));  // used now
  store.keep(key("d"), block);
  EXPECT_FALSE(store.find(key("b")));
  for (const char* name : {"a", "c", "d"}) EXPECT_TRUE(store.find(key(name))) << name;
  store.keep("large", std::string(400, 'x'));
  EXPECT_EQ(files_in(folder.path()), 3U);
}

TEST(ResultStore, RemovesLeftoversOfKilledWrites) {
  const TemporaryFolder folder;
  ResultStore store(folder.path());
  for (const std::string& name : {key("old") + ".result.x.rebake-partial", key("new") + ".result.x.rebake-partial"})
    write_file_atomically(folder.path() / name, "half", {});
  fs::last_write_time(folder.path() / (key("old") + ".result.x.rebake-partial"),
                      fs::file_time_type::clock::now() - std::chrono::hours(2));
  // Files of others stay, also in a folder that the user chose.
  for (const char* name : {"measure.rebake-partial", "scan.result"}) {
    write_file_atomically(folder.path() / name, "mine", {});
    fs::last_write_time(folder.path() / name, fs::file_time_type::clock::now() - std::chrono::hours(2));
  }
  store.keep("k", "bytes");
  for (const char* name : {"measure.rebake-partial", "scan.result"})
    EXPECT_TRUE(fs::exists(folder.path() / name)) << name;
  EXPECT_FALSE(fs::exists(folder.path() / (key("old") + ".result.x.rebake-partial")));
  EXPECT_TRUE(fs::exists(folder.path() / (key("new") + ".result.x.rebake-partial")))
      << "another process may be writing it";
}

TEST(ResultStore, StaysWhereItWasWhenTheFolderChanges) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  const char* const was = std::getenv("REBAKE_RESULTS");
  const std::string kept = was != nullptr ? was : "";
  fs::current_path(folder.path());
  ::setenv("REBAKE_RESULTS", "results", 1);
  const auto store = ResultStore::user_store();
  fs::current_path(before);
  was != nullptr ? ::setenv("REBAKE_RESULTS", kept.c_str(), 1) : ::unsetenv("REBAKE_RESULTS");
  store->keep("k", "bytes");
  EXPECT_EQ(files_in(folder.path() / "results"), 1U);
}

TEST(ResultStore, IgnoresUnwritableFolder) {
  const TemporaryFolder folder;
  write_file_atomically(folder.path() / "file", "", {});
  ResultStore store(folder.path() / "file" / "results");
  EXPECT_NO_THROW(store.keep("k", "bytes"));
  EXPECT_FALSE(store.find("k"));
}

// A wrap is computed once: replay, opening and redo find it, with the same bytes as without a store.
class StoredWraps : public DocumentTest {
 protected:
  ~StoredWraps() override { set_result_cache(nullptr); }
  void bend(Document& document) const {
    import(document);
    act(document,
        R"({"op": "cage", "node": "ball", "wrap": 0.3, "moves": [{"points": [0, 3], "translate": [0.2, 0, 0]}]})");
  }
};

TEST_F(StoredWraps, ReusedByReplayOpeningAndRedo) {
  Document without;
  bend(without);
  const auto bytes = exported(without.scene());
  const auto store = std::make_shared<ResultStore>(path("results"));
  set_result_cache(store);
  Document first;
  bend(first);
  EXPECT_EQ(store->found(), 0U);
  EXPECT_EQ(files_in(path("results")), 1U);
  first.save(path("p.rebake"));
  EXPECT_EQ(exported(Document::open(path("p.rebake")).scene()), bytes);
  EXPECT_EQ(store->found(), 1U);
  Document again({}, 1);  // caches no scenes, so that redo recomputes
  bend(again);
  again.undo();
  again.redo();
  EXPECT_EQ(exported(again.scene()), bytes);
  EXPECT_GE(store->found(), 3U);
  // A stored result that is no cage is computed again.
  const auto file = fs::directory_iterator(path("results"))->path();
  const std::string key = file.stem().string();
  store->keep(key, "no cage");
  Document mended;
  bend(mended);
  EXPECT_EQ(exported(mended.scene()), bytes);
}

}  // namespace
}  // namespace rebake::test
