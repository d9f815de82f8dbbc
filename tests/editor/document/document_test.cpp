// Document: history, journal and project. No edit is lost.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/actions/session.h"
#include "editor/document/document.h"
#include "editor/document/project.h"
#include "editor/edits/nodes/import.h"
#include "editor/script/script.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/document_fixture.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(DocumentTest, UndoAndRedoWalkTheSameScenes) {
  Document document;
  work(document);
  const auto last = exported(document.scene());
  EXPECT_EQ(document.history().undo_count(), 7U);
  for (int k = 0; k < 7; ++k) EXPECT_TRUE(document.undo());
  EXPECT_FALSE(document.undo());
  EXPECT_TRUE(document.scene().roots.empty());
  while (document.redo()) {
  }
  EXPECT_EQ(exported(document.scene()), last);
  document.undo();
  act(document, R"({"op": "rename", "node": "part", "name": "piece"})");
  EXPECT_FALSE(document.redo()) << "a new edit drops undone edits";
}

TEST_F(DocumentTest, RecomputesPreviewResultsForAnotherGround) {
  Document document;
  import(document);
  const Edit move = read_edit({{"op", "transform"}, {"node", "ball"}, {"translate", {0, 1, 0}}}, document.scene());
  const AppliedEdits made = apply_edits(document.scene(), {move});
  act(document, R"({"op": "ground", "height": -3})");
  document.edits({move}, {}, &made);
  EXPECT_EQ(document.scene().ground.height, -3);
}

// A preview's result is committed as it is if it was computed from the same scene and edits; otherwise edits are
// applied again.
TEST_F(DocumentTest, ReusesMatchingPreviewResults) {
  Document document;
  document.keep_journal(path("journal"));
  import(document);
  const auto bend = [&](double degrees) {
    return std::vector<Edit>{read_edit(
        {{"op", "bend"}, {"node", "ball"}, {"degrees", degrees}, {"direction", {0, 1, 0}}, {"axis", {1, 0, 0}}},
        document.scene())};
  };
  const Scene start = document.scene();
  const AppliedEdits made = apply_edits(start, bend(30));
  document.edits(bend(30), {}, &made);
  EXPECT_EQ(document.scene().roots, made.scenes.back().roots);
  document.adjust(bend(30), {}, &made);
  EXPECT_EQ(document.scene().roots, made.scenes.back().roots)
      << "the result was computed from the scene before the step";
  const auto bent = exported(document.scene());
  document.undo();
  document.edits(bend(30));
  EXPECT_EQ(exported(document.scene()), bent) << "the same bytes either way";
  EXPECT_NE(document.scene().roots, made.scenes.back().roots);
  document.edits(bend(30), {}, &made);
  EXPECT_NE(document.scene().roots, made.scenes.back().roots) << "the result is for another scene";
  document.undo(2);
  document.edits(bend(31), {}, &made);
  EXPECT_NE(document.scene().roots, made.scenes.back().roots) << "the result is for another edit";
  document = Document();
  const Scene back = Document::recover(path("journal")).document.scene();
  Document other;
  import(other);
  act(other, {{"op", "bend"}, {"node", "ball"}, {"degrees", 31}, {"direction", {0, 1, 0}}, {"axis", {1, 0, 0}}});
  EXPECT_EQ(exported(back), exported(other.scene()));
}

TEST_F(DocumentTest, FailedEditChangesNothing) {
  Document document;
  import(document);
  const auto node = document.scene().roots[0];
  EXPECT_NE(error_of([&] { document.edit(DeleteSelected{}); }).find("no triangle is selected"), std::string::npos);
  EXPECT_EQ(document.scene().roots[0], node);
  EXPECT_EQ(document.history().undo_count(), 1U);
}

TEST_F(DocumentTest, EvictsScenesWithinBudgetAndRecomputes) {
  Document all, tight({}, 1);
  work(all);
  work(tight);
  EXPECT_EQ(tight.history().kept(), 2U) << "the start and the present";
  EXPECT_LT(tight.history().memory(), all.history().memory());
  while (all.undo()) {
    ASSERT_TRUE(tight.undo());
    if (!all.scene().roots.empty()) {
      ASSERT_EQ(exported(tight.scene()), exported(all.scene()));
    }
  }
  EXPECT_EQ(tight.history().undo_count(), 0U);
}

// Opening a long project, or recomputing an evicted scene, must not hold all scenes on the way in memory.
TEST_F(DocumentTest, ReleasesIntermediateScenes) {
  Document document;
  import(document);
  for (int k = 0; k < 40; ++k) act(document, R"({"op": "bend", "node": "ball", "degrees": 1, "axis": [0, 1, 0]})");
  document.save(path("long.rebake"));
  std::vector<std::weak_ptr<const BakedObject>> passed;
  std::size_t most = 0;
  const auto alive = [&] {
    return static_cast<std::size_t>(
        std::count_if(passed.begin(), passed.end(), [](const auto& one) { return !one.expired(); }));
  };
  read_project(path("long.rebake"), [&](const History::Entry&, const Scene& after) {
    passed.push_back(after.roots[0]->object);
    most = std::max(most, alive());
  });
  EXPECT_EQ(passed.size(), document.history().undo_count());
  EXPECT_LE(most, 3U) << "the previous scene, this one, and a shared one";

  Document tight = Document::open(path("long.rebake"), {}, {}, 1);
  EXPECT_EQ(tight.history().kept(), 2U);
  ASSERT_TRUE(tight.undo());
  EXPECT_EQ(tight.history().kept(), 2U);
  document.undo();
  EXPECT_EQ(exported(tight.scene()), exported(document.scene()));

  // A budget for some scenes caches that many, however far one undoes.
  Document first;
  import(first);
  Document all(first.scene());
  const auto bend_often = [&](Document& one) {
    for (int k = 0; k < 40; ++k) act(one, R"({"op": "bend", "node": "ball", "degrees": 1, "axis": [0, 1, 0]})");
  };
  bend_often(all);
  const std::uint64_t least = first.history().memory(), budget = least + (all.history().memory() - least) / 4;
  Document some(first.scene(), budget);
  bend_often(some);
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(some.undo());
  EXPECT_GT(some.history().kept(), 4U);
  EXPECT_LE(some.history().memory(), budget);
}

TEST_F(DocumentTest, SharedPartsAreCountedOnce) {
  Document document;
  import(document);
  const std::uint64_t one = document.history().memory();
  for (int k = 0; k < 20; ++k) act(document, R"({"op": "transform", "node": "ball", "translate": [1, 0, 0]})");
  EXPECT_LT(document.history().memory(), one + 20 * 1000) << "a moved node shares its triangles and texels";
}

// What could not be replayed can be later, with its sources.
TEST_F(DocumentTest, SourcesOfLostEditsAreNotOverwritten) {
  {
    Document document;
    document.keep_journal(path("j"));
    import(document);
    export_scene(scene_of(made_object({.seed = 5})), path("more"), {});
    const std::string line = R"({"op": "import", "path": ")" + path("more").string() + R"("})";
    act(document, line.c_str());
  }
  std::filesystem::rename(path("sources/ball"), path("moved"));
  const Document::Recovered recovered = Document::recover(path("j"));
  EXPECT_EQ(recovered.lost.size(), 2U);
  EXPECT_THROW(recovered.document.sources().check_file(path("more") / "mlp.json"), FileError);
}

TEST_F(DocumentTest, RecoversFromJournal) {
  Document document;
  document.keep_journal(path("j"));
  work(document);
  document.undo();
  document.undo();
  document.redo();
  const auto bytes = exported(document.scene());
  document = Document();  // simulates the end of the program
  const Document::Recovered recovered = Document::recover(path("j"));
  EXPECT_EQ(recovered.edits, 6U);
  EXPECT_FALSE(recovered.torn);
  EXPECT_EQ(exported(recovered.document.scene()), bytes);
}

TEST_F(DocumentTest, JoinedEditsAreOneStep) {
  Document document;
  document.keep_journal(path("j"));
  import(document);
  act(document, R"({"op": "duplicate", "node": "ball", "as": "other"})");
  const Scene before = document.scene();
  const auto hide = [&](const char* name) { return Edit(Hide{NodeRef{find(document.scene(), name)->id}}); };
  document.edits({hide("ball"), hide("other")});
  const Scene hidden = document.scene();
  EXPECT_EQ(document.history().undo_count(), 4U);
  EXPECT_TRUE(document.undo_step());
  EXPECT_EQ(document.scene().roots, before.roots);
  EXPECT_TRUE(document.redo_step());
  EXPECT_EQ(document.scene().roots, hidden.roots);
  EXPECT_FALSE(document.redo_step());

  // If one edit fails, nothing changes and redo stays possible.
  document.undo_step();
  EXPECT_THROW(document.edits({hide("ball"), Hide{NodeRef{static_cast<NodeId>(99)}}}), Error);
  EXPECT_EQ(document.scene().roots, before.roots);
  EXPECT_TRUE(document.redo_step());

  // A script may undo single edits of a step; redo_step() restores the rest of the step.
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.redo_step());
  EXPECT_EQ(document.scene().roots, hidden.roots);
  EXPECT_FALSE(document.undo(9)) << "undo must do all requested steps or none";
  EXPECT_EQ(document.scene().roots, hidden.roots);

  document.save(path("p.rebake"));
  document = Document();
  Document recovered = Document::recover(path("j")).document, opened = Document::open(path("p.rebake"));
  for (Document* again : {&recovered, &opened}) {
    EXPECT_FALSE(find(again->scene(), "ball")->visible);
    EXPECT_TRUE(again->undo_step());
    EXPECT_EQ(again->history().undo_count(), 2U);
    EXPECT_TRUE(find(again->scene(), "ball")->visible);
  }
}

TEST_F(DocumentTest, UndoFailsIfTheJournalCannotBeWritten) {
  Document document;
  document.keep_journal(path("j"));
  import(document);
  const Edit hide = Hide{NodeRef{find(document.scene(), "ball")->id}},
             show = Show{NodeRef{find(document.scene(), "ball")->id}};
  document.edits({hide, show, hide});
  const Scene before = document.scene();
  // Simulates a full disk.
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit full{fs::file_size(path("j")), limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  EXPECT_THROW(document.undo_step(), FileError);
  EXPECT_THROW(document.edits({show, hide}), FileError);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  ::signal(SIGXFSZ, handler);
  EXPECT_EQ(document.scene().roots, before.roots);
  EXPECT_TRUE(document.undo_step());
  document = Document();
  const Document::Recovered recovered = Document::recover(path("j"));
  EXPECT_EQ(recovered.edits, 1U);
  EXPECT_TRUE(find(recovered.document.scene(), "ball")->visible);
}

TEST_F(DocumentTest, ScriptJournalAndProjectGiveTheSameBytes) {
  Document document;
  document.keep_journal(path("j"));
  work(document);
  document.save(path("p.rebake"));
  const auto bytes = exported(document.scene());
  document = Document();
  EXPECT_EQ(exported(Document::recover(path("j")).document.scene()), bytes);
  EXPECT_EQ(exported(Document::open(path("p.rebake")).scene()), bytes);
  Session session;
  run_script(session, R"({"op": "import", "path": "{from}", "as": "ball"}
{"op": "select", "node": "ball", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"}
{"op": "delete"}
{"op": "select", "box": {"min": [0, 0, 0], "max": [0.5, 1, 1]}, "frame": "bounds"}
{"op": "separate", "node": "ball", "as": "part"}
{"op": "transform", "node": "part", "translate": [3, 0, 0]}
{"op": "erase", "node": "part", "sphere": {"center": [2, 0, 0], "radius": 0.6}}
)",
             "s", {{"from", path("sources/ball").string()}});
  EXPECT_EQ(exported(session.scene()), bytes);
}

TEST_F(DocumentTest, TruncatedJournalLosesAtMostTheLastEdit) {
  Document document;
  document.keep_journal(path("j"));
  for (int k = 0; k < 3; ++k) act(document, json{{"op", "background"}, {"color", {k / 3.0, 0, 0}}});
  const std::string whole = read_file(path("j"));
  document = Document();
  const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t size = last; size <= whole.size(); ++size) {
    std::ofstream(path("cut"), std::ios::binary) << whole.substr(0, size);
    Document::Recovered recovered = Document::recover(path("cut"));
    // A last line that lacks only its newline is complete.
    ASSERT_EQ(recovered.edits, size + 1 >= whole.size() ? 3U : 2U) << size;
    ASSERT_EQ(recovered.torn, size > last && size + 1 < whole.size()) << size;
    // New edits are appended behind the last complete line.
    act(recovered.document, R"({"op": "background", "color": [0, 1, 0]})");
    const std::size_t edits = recovered.edits + 1;
    recovered.document = Document();
    ASSERT_EQ(Document::recover(path("cut")).edits, edits) << size;
    fs::remove(path("cut"));
  }
}

TEST_F(DocumentTest, ReportedEditsSurviveKills) {
  // The child reports each finished edit by one byte. Both the first run and the recovered one are killed.
  std::mt19937 random(11);
  int in_flight = 0;
  for (int round = 0; round < cases(80, 400); ++round) {
    const fs::path journal = path(fmt::format("k{}", round));
    std::size_t reported = 0;
    for (int life = 0; life < 2; ++life) {
      int ends[2];
      ASSERT_EQ(pipe(ends), 0);
      const pid_t child = fork();
      if (child == 0) {
        close(ends[0]);
        try {
          Document document;
          if (life == 0)
            document.keep_journal(journal);
          else
            document = std::move(Document::recover(journal).document);
          for (int k = 0;; ++k) {
            Background edit;
            edit.color = Color(0.5, 0.25, (k % 100) / 100.0);
            document.edit(edit);
            if (write(ends[1], "", 1) != 1) _exit(1);
          }
        } catch (...) {
          _exit(1);
        }
      }
      close(ends[1]);
      usleep(static_cast<useconds_t>(random() % 4000));
      kill(child, SIGKILL);
      int status = 0;
      waitpid(child, &status, 0);
      ASSERT_TRUE(WIFSIGNALED(status)) << "the child was not killed but failed";
      char byte = 0;
      while (read(ends[0], &byte, 1) == 1) ++reported;
      close(ends[0]);
      if (!fs::exists(journal)) break;
      const Journal::Contents contents = Journal::read(journal);
      ASSERT_GE(contents.entries.size(), reported) << round;
      ASSERT_LE(contents.entries.size(), reported + 1 + static_cast<std::size_t>(life)) << round;
      in_flight += contents.entries.size() > reported ? 1 : 0;
      reported = contents.entries.size();
    }
    if (fs::exists(journal)) {
      EXPECT_EQ(Document::recover(journal).edits, reported);
    }
  }
  RecordProperty("killed_between_disk_and_report", in_flight);
}

TEST_F(DocumentTest, RejectsInvalidJournalsWithReason) {
  const auto says = [&](const std::string& bytes, const std::string& what) {
    std::ofstream(path("bad"), std::ios::binary) << bytes;
    const std::string error = error_of([&] { Document::recover(path("bad")); });
    EXPECT_NE(error.find(what), std::string::npos) << error;
    EXPECT_EQ(read_file(path("bad")), bytes) << "the file must not change";
  };
  says(std::string(300, 'x'), "is not a Rebake journal");
  {
    Document document;
    document.keep_journal(path("j"));
    for (int k = 0; k < 3; ++k) act(document, R"({"op": "background", "color": [0, 0, 1]})");
    EXPECT_NE(error_of([&] { Document().keep_journal(path("j")); }).find("already exists"), std::string::npos);
    EXPECT_NE(error_of([&] { Document::recover(path("j")); }).find("is in use by another Rebake process"),
              std::string::npos);
  }
  const auto line = [](const std::string& text) { return hash_text(content_hash(text)) + " " + text + "\n"; };
  says(line(R"({"rebake_journal":4})"), "newer version");
}

TEST_F(DocumentTest, LeavesOtherFilesAlone) {
  for (const std::string& bytes :
       {std::string("my shopping list\n"), std::string("0123456789abcdef {\n"), std::string("x")}) {
    write_text(path("notes.txt"), bytes);
    EXPECT_NE(error_of([&] { Document::recover(path("notes.txt")); }).find("is not a Rebake journal"),
              std::string::npos);
    EXPECT_EQ(read_file(path("notes.txt")), bytes);
  }
  EXPECT_NE(error_of([&] { Document::recover(path("sources")); }).find("not a file"), std::string::npos);
  // If the program was killed while it wrote the first line, the journal contains no edit and can be continued.
  write_text(path("empty"), "");
  Document::Recovered recovered = Document::recover(path("empty"));
  act(recovered.document, R"({"op": "background", "color": [0, 0, 1]})");
  recovered.document = Document();
  EXPECT_EQ(Document::recover(path("empty")).edits, 1U);
}

TEST_F(DocumentTest, SkipsHiddenAndLockedNodesByDefault) {
  Document document;
  import(document);
  act(document, R"({"op": "duplicate", "node": "ball", "as": "kept"})");
  act(document, R"({"op": "select", "node": "kept", "all": true})");
  for (const char* op : {"hide", "lock"}) {
    act(document, json{{"op", op}, {"node", "kept"}});
    act(document, R"({"op": "select", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}})");
    act(document, R"({"op": "grow"})");
    act(document, R"({"op": "delete"})");
    EXPECT_EQ(find(document.scene(), "kept")->object->triangle_count(), 256U) << op;
    document.undo();
    document.undo();
    document.undo();
    document.undo();
  }
  act(document, R"({"op": "lock", "node": "kept"})");
  EXPECT_NE(error_of([&] { act(document, R"({"op": "delete", "node": "kept"})"); }).find("is locked"),
            std::string::npos);
}

TEST_F(DocumentTest, ProjectsMoveWithTheirSourcesAndReportWhatChanged) {
  Document document;
  work(document);
  act(document, R"({"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}})");
  document.save(path("p.rebake"));
  const auto bytes = exported(document.scene());
  fs::create_directory(path("elsewhere"));
  fs::copy(path("p.rebake"), path("elsewhere/p.rebake"));
  fs::copy(path("sources"), path("elsewhere/sources"), fs::copy_options::recursive);
  fs::rename(path("sources"), path("gone"));
  const Document opened = Document::open(path("elsewhere/p.rebake"));
  EXPECT_EQ(exported(opened.scene()), bytes);
  EXPECT_TRUE(opened.scene().views.contains("front"));
  EXPECT_NE(error_of([&] { Document::open(path("p.rebake")); }).find("sources/ball no longer exists"),
            std::string::npos);
  std::ofstream(path("elsewhere/sources/ball/mlp.json"), std::ios::app) << " ";
  EXPECT_NE(error_of([&] { Document::open(path("elsewhere/p.rebake")); }).find("sources/ball has changed"),
            std::string::npos);
}

TEST_F(DocumentTest, RejectsInvalidProjectsWithReason) {
  const auto says = [&](const std::string& text, const std::string& what) {
    write_text(path("bad.rebake"), text);
    const std::string error = error_of([&] { Document::open(path("bad.rebake")); });
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  says("{", "is not a valid project");
  says("{}", "is not a Rebake project");
  says(R"({"rebake_project": 9, "sources": [], "edits": []})", "newer version");
  says(R"({"rebake_project": 1, "edits": []})", "sources");
  says(R"({"rebake_project": 1, "sources": [], "edits": [{"op": "remove", "node": 3}]})", "edit 1: ");
  says(R"({"rebake_project": 1, "sources": [], "edits": [{"op": "render"}]})", "is not an edit");
}

// A node keeps its name even if a project later finds its folder under another name, through a link or after a move.
TEST_F(DocumentTest, ImportsKeepNodeNames) {
  std::filesystem::create_directory_symlink(path("sources/ball"), path("link"));
  Document document;
  for (int twice = 0; twice < 2; ++twice)
    act(document, nlohmann::json{{"op", "import"}, {"path", path("link").string()}});
  act(document, R"({"op": "duplicate", "node": "link", "as": "ball"})");
  EXPECT_EQ(document.history().edits()[0].as<Import>()->as, "link");
  EXPECT_EQ(document.history().edits()[1].as<Import>()->as, "link.2");
  write_project(path("p.rebake"), document.history().entries(), {});
  Scene opened;
  read_project(path("p.rebake"), [&](const History::Entry&, const Scene& after) { opened = after; });
  ASSERT_EQ(opened.roots.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(opened.roots[k]->name, document.scene().roots[k]->name);
}

TEST_F(DocumentTest, SavingKeepsWhatAnotherProgramSavedMeanwhile) {
  Document first;
  import(first);
  first.save(path("p.rebake"));
  Document other = Document::open(path("p.rebake")), same = Document::open(path("p.rebake"));
  act(other, R"({"op": "background", "color": [1, 0, 0]})");
  other.save(path("p.rebake"));
  const std::string newest = read_file(path("p.rebake"));
  act(same, R"({"op": "background", "color": [0, 1, 0]})");
  for (Document* document : {&first, &same}) {
    try {
      document->save(path("p.rebake"));
      ADD_FAILURE() << "replaced edits of another program";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("was changed by another program"), std::string::npos) << error.what();
    }
    EXPECT_EQ(read_file(path("p.rebake")), newest);
  }
  other.undo();
  other.save(path("p.rebake"));
  same.save(path("p.rebake"), {}, Document::OtherProject::replace);
  EXPECT_EQ(Document::open(path("p.rebake")).history().undo_count(), 2U);
}

TEST_F(DocumentTest, OtherProjectsAreReplacedWithAWarningOrNotAtAll) {
  Document one, other;
  import(one);
  act(one, R"({"op": "background", "color": [1, 0, 0]})");
  one.save(path("p.rebake"));
  import(other);
  EXPECT_THROW(other.save(path("p.rebake")), FileError) << "it has more edits";
  act(other, R"({"op": "background", "color": [0, 0, 1]})");
  EXPECT_THROW(other.save(path("p.rebake"), {}, Document::OtherProject::keep), FileError);
  const std::vector<std::string> warnings = other.save(path("p.rebake")).warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0], "it replaced a project with 1 other edit");
  EXPECT_TRUE(other.save(path("p.rebake")).warnings.empty());
}

}  // namespace
}  // namespace rebake::test
