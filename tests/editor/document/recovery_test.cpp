// Recovery of work: damaged journals and projects, moved sources, files behind links. Files are removed only after
// their replacement is on the disk.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/document/document.h"
#include "editor/document/journal.h"
#include "editor/document/project.h"
#include "editor/edits/nodes/view.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"
#include "tests/support/power_loss.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Recovery : public ::testing::Test {
 protected:
  Recovery() { export_scene(scene_of(made_object({.columns = 4, .rows = 2})), path("sources/ball"), {}); }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  static void write(const fs::path& to, const std::string& bytes) { std::ofstream(to, std::ios::binary) << bytes; }

  // Writes a journal of an import and `edits` background edits; returns its bytes.
  std::string journal(int edits, const std::string& name = "journal") const {
    Document document;
    document.keep_journal(path(name));
    work(document, edits);
    return read_file(path(name));
  }
  void work(Document& document, int edits) const {
    Import import;
    import.path = path("sources/ball").string();
    document.edit(import);
    for (int k = 0; k < edits; ++k) {
      Background edit;
      edit.color = Vec3(0, 0, k / 100.0);
      document.edit(edit);
    }
  }
  TemporaryFolder folder_;
};

TEST_F(Recovery, RecoversEverythingBeforeAFlippedBit) {
  const std::string bytes = journal(42);
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::string damaged = bytes;
    const std::size_t at = trial == 0 ? damaged.size() - 1 : random() % damaged.size();
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    const auto line =
        static_cast<std::size_t>(std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    write(path("damaged"), damaged);
    const Document::Recovered recovered = Document::recover(path("damaged"));
    // Lines 1 … contain edits. Damage to line 0 or to the last newline loses none.
    const bool loses = line > 0 && at + 1 < bytes.size();
    EXPECT_EQ(recovered.edits, loses ? line - 1 : 43) << "byte " << at;
    EXPECT_FALSE(recovered.torn) << at;
    if (loses) {
      EXPECT_GE(recovered.lost.size(), std::max<std::size_t>(1, 43 - line)) << at << ": lost edits must be listed";
    }
    EXPECT_EQ(read_file(path("damaged")).substr(0, damaged.size() / 2), damaged.substr(0, damaged.size() / 2));
  }
}

// A tail of zeros may have been any number of lines, which were on the disk before.
TEST_F(Recovery, ZerosAtTheEndAreDamageAndReadingChangesNothing) {
  const std::string bytes = journal(6);
  const std::size_t third = bytes.find('\n', bytes.find('\n', bytes.find('\n') + 1) + 1) + 11;
  const std::string zeroed = bytes.substr(0, third) + std::string(bytes.size() - third, '\0');
  write(path("zeroed"), zeroed);
  const Document::Recovered damaged = Document::recover(path("zeroed"));
  EXPECT_FALSE(damaged.lost.empty());
  EXPECT_FALSE(damaged.document.keeps_journal());
  EXPECT_EQ(read_file(path("zeroed")), zeroed);
  // A torn line is removed only when another edit follows.
  const std::string torn = bytes.substr(0, third);
  write(path("torn"), torn);
  write(path("empty"), "");
  {
    Document::Recovered read = Document::recover(path("torn"));
    EXPECT_TRUE(read.torn);
    EXPECT_EQ(read_file(path("torn")), torn);
    Document::recover(path("empty"));
    EXPECT_EQ(read_file(path("empty")), "");
    read.document.edit(Background{});
  }
  const Document::Recovered again = Document::recover(path("torn"));
  EXPECT_FALSE(again.torn);
  EXPECT_TRUE(again.lost.empty());
  EXPECT_EQ(again.edits, 3U);
}

TEST_F(Recovery, RepairsThatFailAreTriedAgain) {
  const std::string bytes = journal(6);
  for (const std::string& torn :
       {bytes.substr(0, bytes.size() - 1), bytes.substr(0, bytes.size() - 9), std::string()}) {
    write(path("torn"), torn);
    std::size_t edits = 0;
    {
      Document::Recovered read = Document::recover(path("torn"));
      edits = read.edits;
      for (int call = 0; call < 2; ++call) {
        PowerLoss full;
        full.fail_at(call, ENOSPC);
        const ReplacedFileCalls fails(full);
        EXPECT_THROW(read.document.edit(Background{}), FileError) << call;
      }
      read.document.edit(Background{});
    }
    const Document::Recovered again = Document::recover(path("torn"));
    EXPECT_FALSE(again.torn) << torn.size();
    EXPECT_TRUE(again.lost.empty()) << torn.size();
    EXPECT_EQ(again.edits, edits + 1) << torn.size();
  }
}

TEST_F(Recovery, JournalsOfRelativePathsStayWhereTheyAre) {
  write(path("j"), journal(3));
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  {
    Document::Recovered read = Document::recover("j");
    fs::current_path(before);
    read.document.edit(Background{});
  }
  EXPECT_EQ(Document::recover(path("j")).edits, 5U);
}

TEST_F(Recovery, DoesNotAppendToOlderJournals) {
  const auto line = [](const std::string& text) { return hash_text(content_hash(text)) + " " + text + "\n"; };
  write(path("old"),
        line(R"({"rebake_journal":2})") + line(R"({"edit":{"color":[0.0,0.0,0.5],"op":"background"},"n":1})"));
  Document::Recovered recovered = Document::recover(path("old"));
  EXPECT_EQ(recovered.edits, 1U);
  EXPECT_FALSE(recovered.document.keeps_journal()) << "a new journal must be begun";
  EXPECT_TRUE(recovered.journal);
}

TEST_F(Recovery, AdjustedStepIsAtomic) {
  const auto background = [](double blue) {
    Background edit;
    edit.color = Vec3(0, 0, blue);
    return edit;
  };
  Document document;
  document.keep_journal(path("journal"));
  work(document, 0);
  document.edits({background(0.25), background(0.5)});
  const std::string before = read_file(path("journal"));
  document.adjust({background(0.75)});
  const std::string after = read_file(path("journal"));
  EXPECT_EQ(document.history().undo_count(), 2U) << "an import, and the step that took the place of two edits";
  for (std::size_t end = before.size(); end <= after.size(); ++end) {
    write(path("cut"), after.substr(0, end));
    Document::Recovered recovered = Document::recover(path("cut"));
    const bool whole = end + 1 >= after.size();  // the newline at the end may be missing
    EXPECT_EQ(recovered.document.scene().background, Vec3(0, 0, whole ? 0.75 : 0.5)) << end;
    EXPECT_EQ(recovered.document.history().undo_count(), whole ? 2U : 3U);
    fs::remove(path("cut"));
  }
  // If the new step fails, the old one and the journal stay.
  StoreView header_damaged;
  EXPECT_THROW(document.adjust({header_damaged}), Error);
  EXPECT_EQ(document.scene().background, Vec3(0, 0, 0.75));
  EXPECT_EQ(read_file(path("journal")), after);
}

TEST_F(Recovery, ListsEditsBehindDamageAndKeepsTheJournal) {
  std::string bytes = journal(5);
  const std::size_t at = bytes.find("0.02");
  bytes[at] = '7';
  write(path("damaged"), bytes);
  Document::Recovered recovered = Document::recover(path("damaged"));
  EXPECT_EQ(recovered.edits, 3U);
  ASSERT_EQ(recovered.lost.size(), 3U);
  EXPECT_EQ(recovered.lost[0], "line 5 is damaged");
  EXPECT_NE(recovered.lost[1].find("line 6: background (behind the damage)"), std::string::npos) << recovered.lost[1];
  EXPECT_FALSE(recovered.document.keeps_journal()) << "no edit may be written behind damage";
  recovered.document.edit(Background{});
  EXPECT_EQ(read_file(path("damaged")), bytes);
}

TEST_F(Recovery, NamesAndRelinksMovedSources) {
  journal(3);
  fs::create_directory(path("elsewhere"));
  fs::rename(path("sources/ball"), path("elsewhere/ball"));
  {
    const Document::Recovered without = Document::recover(path("journal"));
    EXPECT_EQ(without.edits, 0U);
    EXPECT_EQ(without.lost.size(), 4U);
    ASSERT_EQ(without.gone.size(), 1U);
    EXPECT_EQ(without.gone[0].path, path("sources/ball"));
  }
  // Relinks the folder itself, or a folder above it.
  for (const auto& [from, to] : {std::pair("sources/ball", "elsewhere/ball"), std::pair("sources", "elsewhere")}) {
    Document::Recovered found = Document::recover(path("journal"), {{path(from), path(to)}});
    EXPECT_EQ(found.edits, 4U) << from;
    EXPECT_TRUE(found.lost.empty());
    found.document.save(path("p.rebake"));
    EXPECT_EQ(Document::open(path("p.rebake")).history().undo_count(), 4U);
  }
  // The most specific of several links applies.
  EXPECT_EQ(
      Document::recover(path("journal"), {{path("."), path("nowhere")}, {path("sources/ball"), path("elsewhere/ball")}})
          .edits,
      4U);
  EXPECT_THROW(Document::recover(path("journal"), {{path("source"), path("elsewhere")}}), FieldError)
      << "an unused link must be rejected";
  // Another scene at the new path is not accepted.
  export_scene(scene_of(made_object({.columns = 6, .rows = 2})), path("other"), {});
  EXPECT_EQ(Document::recover(path("journal"), {{path("sources/ball"), path("other")}}).edits, 0U);
}

TEST_F(Recovery, RelinksTwoSourcesOfOnePath) {
  Document document;
  document.keep_journal(path("journal"));
  const auto import = [&] {
    Import edit;
    edit.path = path("sources/ball").string();
    document.edit(edit);
  };
  import();
  fs::rename(path("sources/ball"), path("first"));
  export_scene(scene_of(made_object({.columns = 6, .rows = 2})), path("sources/ball"), {});
  import();
  const std::vector<std::string> warnings = document.save(path("p.rebake")).warnings;
  EXPECT_FALSE(document.save(path("q.rebake")).opens);
  ASSERT_EQ(warnings.size(), 1U) << "the first source is missing";
  EXPECT_NE(warnings[0].find("has changed since it was imported"), std::string::npos) << warnings[0];
  document = Document();
  EXPECT_THROW(Document::open(path("p.rebake")), SourcesUnavailable);
  // The second source is at its old path, then moved too.
  SourceLinks links{{path("sources/ball"), path("first")}};
  EXPECT_EQ(Document::open(path("p.rebake"), links).history().undo_count(), 2U);
  fs::rename(path("sources/ball"), path("second"));
  links.emplace(path("sources/ball"), path("second"));
  EXPECT_EQ(Document::open(path("p.rebake"), links).history().undo_count(), 2U);
  EXPECT_EQ(Document::recover(path("journal"), links).edits, 2U);
}

// Programs for backups make hard links instead of copies.
TEST_F(Recovery, HardLinksOfAJournalKeepTheirContent) {
  const std::string torn = journal(3) + "torn";
  write_text(path("journal"), torn);
  fs::create_hard_link(path("journal"), path("backup"));
  Document::Recovered recovered = Document::recover(path("journal"));
  Background edit;
  edit.color = Vec3(0, 0, 1);
  recovered.document.edit(edit);
  EXPECT_EQ(read_file(path("backup")), torn);
  fs::create_hard_link(path("journal"), path("second"));
  const std::string second = read_file(path("second"));
  edit.color = Vec3(0, 1, 0);
  recovered.document.edit(edit);
  EXPECT_EQ(read_file(path("second")), second);
  EXPECT_EQ(Journal::read(path("journal")).entries.size(), 6U);
  EXPECT_TRUE(Journal::in_use(path("journal"))) << "the new file is locked, too";
}

// A journal that begins after an undo contains the undone edits, because they can be redone.
TEST_F(Recovery, JournalBegunAfterUndoRecoversRedoneEdits) {
  Document document;
  work(document, 3);
  Background revised;
  revised.color = Vec3(1, 0, 0);
  document.revise({revised});
  ASSERT_TRUE(document.undo(3));
  document.keep_journal(path("journal"));
  ASSERT_TRUE(document.redo(3));
  Background last;
  last.color = Vec3(0, 1, 0);
  document.edit(last);
  const std::size_t edits = document.history().undo_count();
  document = Document();
  const Document::Recovered recovered = Document::recover(path("journal"));
  EXPECT_TRUE(recovered.lost.empty());
  EXPECT_EQ(recovered.edits, edits);
  EXPECT_EQ(recovered.document.scene().background, last.color);
}

TEST_F(Recovery, RecoversFromReadOnlyMedia) {
  class ReadOnly final : public FileCalls {
   public:
    int open(const char* path, int flags, mode_t mode) override {
      if ((flags & O_ACCMODE) == O_RDONLY) return FileCalls::open(path, flags, mode);
      errno = EROFS;
      return -1;
    }
  };
  const std::string bytes = journal(3);
  ReadOnly calls;
  const ReplacedFileCalls replaced(calls);
  const Document::Recovered recovered = Document::recover(path("journal"));
  EXPECT_EQ(recovered.edits, 4U);
  EXPECT_TRUE(recovered.lost.empty());
  EXPECT_FALSE(recovered.document.keeps_journal());
  EXPECT_FALSE(recovered.journal);
  EXPECT_EQ(read_file(path("journal")), bytes);
}

// Undone steps that could be redone are said to be left out.
TEST_F(Recovery, CountsUndoneStepsThatCannotBeRecovered) {
  export_scene(scene_of(made_object({.columns = 6, .rows = 2})), path("sources/second"), {});
  {
    Document document;
    document.keep_journal(path("journal"));
    work(document, 2);
    Import second;
    second.path = path("sources/second").string();
    document.edit(second);
    ASSERT_TRUE(document.undo(2));
  }
  EXPECT_EQ(Document::recover(path("journal")).skipped_undone, 0U);
  fs::rename(path("sources/second"), path("elsewhere"));
  const Document::Recovered recovered = Document::recover(path("journal"));
  EXPECT_TRUE(recovered.lost.empty());
  EXPECT_EQ(recovered.edits, 2U);
  EXPECT_EQ(recovered.skipped_undone, 2U);
}

// An import that adds no node gets no name, which would be that of another node.
TEST_F(Recovery, ScenesWithoutObjectsAreImportedAgain) {
  {
    Document empty;
    StoreView view;
    view.name = "v";
    view.camera = Camera{};
    empty.edit(view);
    format_named("rebake").write(empty.scene(), path("empty"), {}, {});
  }
  for (const bool first : {true, false}) {
    Document document;
    document.keep_journal(path(first ? "j1" : "j2"));
    if (!first) work(document, 0);
    Import import;
    import.path = path("empty").string();
    document.edit(import);
    Background edit;
    edit.color = Vec3(1, 0, 0);
    document.edit(edit);
    EXPECT_TRUE(document.scene().views.contains("v"));
    document.save(path(first ? "p1.rebake" : "p2.rebake"));
    EXPECT_EQ(Document::open(path(first ? "p1.rebake" : "p2.rebake")).scene().background, Vec3(1, 0, 0));
    const std::size_t edits = document.history().undo_count();
    document = Document();
    EXPECT_EQ(Document::recover(path(first ? "j1" : "j2")).edits, edits);
  }
}

TEST_F(Recovery, UndoneImportNeedsNoSource) {
  export_scene(scene_of(made_object({.columns = 6, .rows = 2})), path("sources/wrong"), {});
  const auto background = [](Document& document, double blue) {
    Background edit;
    edit.color = Vec3(0, 0, blue);
    document.edit(edit);
  };
  Document document;
  document.keep_journal(path("journal"));
  Import wrong;
  wrong.path = path("sources/wrong").string();
  document.edit(wrong);
  background(document, 0.25);
  ASSERT_TRUE(document.undo(2));
  work(document, 2);
  background(document, 0.5);
  Background adjusted;
  adjusted.color = Vec3(0, 0, 0.75);
  document.adjust({adjusted});
  const Scene made = document.scene();
  document = Document();
  fs::rename(path("sources/wrong"), path("elsewhere"));
  {
    const Document::Recovered recovered = Document::recover(path("journal"));
    EXPECT_TRUE(recovered.lost.empty());
    EXPECT_EQ(recovered.edits, 4U);
    EXPECT_EQ(recovered.document.scene().background, made.background);
    EXPECT_EQ(recovered.document.scene().roots.size(), 1U);
    EXPECT_FALSE(recovered.document.keeps_journal()) << "the journal contains more edits than the history";
    EXPECT_EQ(recovered.skipped_undone, 0U) << "new steps replaced those that were undone";
  }
  // An import that is not undone still needs its source.
  fs::rename(path("sources/ball"), path("ball"));
  EXPECT_FALSE(Document::recover(path("journal")).lost.empty());
}

TEST_F(Recovery, OpensProjectsByAnyPath) {
  fs::create_directories(path("real/projects"));
  fs::create_directory_symlink(path("real/projects"), path("link"));
  Document document;
  work(document, 2);
  document.save(path("link/p.rebake"));
  for (const char* spelling : {"link/p.rebake", "real/projects/p.rebake", "link/.//p.rebake"})
    EXPECT_EQ(Document::open(path(spelling)).history().undo_count(), 3U) << spelling;
  // Also if the source was imported through a link.
  fs::create_directory_symlink(path("sources"), path("linked"));
  Document other;
  Import import;
  import.path = path("linked/ball").string();
  other.edit(import);
  other.save(path("real/projects/q.rebake"));
  fs::remove(path("linked"));
  EXPECT_EQ(Document::open(path("link/q.rebake")).history().undo_count(), 1U);
}

TEST_F(Recovery, RejectsProjectWithFlippedBit) {
  Document document;
  work(document, 12);
  document.save(path("p.rebake"));
  const std::string bytes = read_file(path("p.rebake"));
  const json meant = json::parse(bytes);
  std::mt19937 random(3);
  for (int trial = 0; trial < 400; ++trial) {
    std::string damaged = bytes;
    const std::size_t at = random() % damaged.size();
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    if (json::parse(damaged, nullptr, false) == meant) continue;  // changed white space
    write(path("damaged.rebake"), damaged);
    EXPECT_THROW(Document::open(path("damaged.rebake")), Error) << "byte " << at << " of\n" << damaged;
  }
  // After a manual change, the checksum must be removed.
  json changed = meant;
  changed["edits"].back()["color"] = {1, 0, 0};
  write(path("hand.rebake"), changed.dump());
  EXPECT_THROW(Document::open(path("hand.rebake")), FileError);
  changed.erase("checksum");
  write(path("hand.rebake"), changed.dump());
  EXPECT_EQ(Document::open(path("hand.rebake")).scene().background, Color(1, 0, 0));
}

TEST_F(Recovery, RemovesJournalOnlyAfterProjectIsSynced) {
  Document document;
  document.keep_journal(path("journal"));
  work(document, 2);
  PowerLoss calls;
  const ReplacedFileCalls in_use(calls);
  document.save(path("p.rebake"));
  EXPECT_EQ(calls.violations(), "");
  document.discard_journal();
  EXPECT_EQ(calls.violations(), "");
  const auto& log = calls.log();
  const auto renamed =
      std::find_if(log.begin(), log.end(), [](const std::string& call) { return call.starts_with("rename"); });
  const auto folder_synced = std::find(renamed, log.end(), "sync " + folder_.path().string());
  const auto unlinked = std::find(log.begin(), log.end(), "unlink " + path("journal").string());
  EXPECT_LT(renamed, folder_synced);
  EXPECT_LT(folder_synced, unlinked);
  EXPECT_NE(unlinked, log.end());
}

TEST_F(Recovery, SyncsEveryEditBeforeItIsApplied) {
  PowerLoss calls;
  const ReplacedFileCalls in_use(calls);
  Document document;
  document.keep_journal(path("journal"));
  EXPECT_EQ(calls.violations(), "");
  work(document, 1);
  EXPECT_EQ(calls.violations(), "");
  for (const int error : {ENOSPC, EIO}) {
    PowerLoss full;
    full.fail_at(0, error);
    const ReplacedFileCalls fails(full);
    EXPECT_THROW(document.edit(Background{}), FileError);
    EXPECT_EQ(document.history().undo_count(), 2U) << "an edit without a journal line must not be applied";
  }
  document.edit(Background{});
  EXPECT_EQ(document.history().undo_count(), 3U);
}

// Each of these would overwrite or change a source.
TEST_F(Recovery, ProtectsSourcesOfUndoneImports) {
  Document document;
  work(document, 0);
  document.undo();
  const SourceGuard guard = document.sources();
  EXPECT_THROW(guard.check_folder(path("sources/ball")), FileError);
  EXPECT_THROW(guard.check_folder(path("sources")), FileError);
  EXPECT_THROW(document.save(path("sources/ball/p.rebake")), FileError);
  EXPECT_THROW(document.keep_journal(path("sources/ball/journal")), FileError);
  // Also if a new edit has dropped the undone import from the history, because the journal still contains it.
  Document went_on;
  work(went_on, 0);
  while (went_on.undo()) {
  }
  went_on.edit(Background{});
  EXPECT_THROW(went_on.sources().check_folder(path("sources/ball")), FileError);
  // Other files in a scene folder are not part of its content.
  document.redo();
  document.save(path("p.rebake"));
  fs::create_directory(path("sources/ball/pictures"));
  write(path("sources/ball/pictures/shape0.obj"), "not of this scene");
  write(path("sources/ball/notes.txt"), "mine");
  EXPECT_NO_THROW(Document::open(path("p.rebake")));
}

}  // namespace
}  // namespace rebake::test
