// `rebake recover`.
#include <gtest/gtest.h>

#include "mesh_ops/base/files.h"
#include "tests/support/cli_fixture.h"

namespace rebake::test {
namespace {

// A run that fails after some edits keeps them in its journal.
TEST_F(Cli, RecoverNamesMissingSourcesAndWritesNoEmptyProject) {
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n" +
                            R"({"op": "hide", "node": "ball"})" + "\n" + R"({"op": "hide", "node": "nobody"})" + "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 1);
  std::filesystem::rename(in("ball"), in("moved"));
  const ProgramResult gone = rebake_run("recover " + in("j") + " -o " + in("p.rebake"));
  EXPECT_EQ(gone.code, 1) << gone.text;
  EXPECT_NE(gone.text.find("--source '" + in("ball") + "=NEW'"), std::string::npos) << gone.text;
  EXPECT_FALSE(std::filesystem::exists(in("p.rebake"))) << "a file would block the next attempt";
  const ProgramResult wrong =
      rebake_run("recover " + in("j") + " -o " + in("p.rebake --source ") + in("bal=") + in("moved"));
  EXPECT_NE(wrong.text.find("contains no source"), std::string::npos) << wrong.text;
  EXPECT_NE(wrong.text.find(in("ball")), std::string::npos) << wrong.text;
  const ProgramResult missed =
      rebake_run("recover " + in("j") + " -o " + in("p.rebake --source ") + in("ball=") + in("mov"));
  EXPECT_NE(missed.text.find("(expected at " + in("mov")), std::string::npos) << missed.text;
  const ProgramResult found =
      rebake_run("recover " + in("j") + " -o " + in("p.rebake --source ") + in("ball=") + in("moved"));
  EXPECT_EQ(found.code, 0) << found.text;
  EXPECT_TRUE(std::filesystem::exists(in("p.rebake")));
  EXPECT_FALSE(std::filesystem::exists(in("j")));
  // An empty journal (killed while it was begun) contains nothing to recover, and stays.
  write_file_atomically(in("empty"), "", {});
  EXPECT_EQ(rebake_run("recover " + in("empty") + " -o " + in("q.rebake")).code, 1);
  EXPECT_TRUE(std::filesystem::exists(in("empty")));
  EXPECT_FALSE(std::filesystem::exists(in("q.rebake")));
}

TEST_F(Cli, RecoverKeepsProjectWithMoreEdits) {
  const std::string import = R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n",
                    hide = R"({"op": "hide", "node": "ball"})"
                           "\n";
  write_file_atomically(in("s.jsonl"), import + hide + R"({"op": "save_project", "out": ")" + in("p.rebake") + "\"}\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl")).code, 0);
  write_file_atomically(in("s.jsonl"),
                        import + R"({"op": "hide", "node": "nobody"})"
                                 "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 1);
  const std::string project = read_file(in("p.rebake"));
  const ProgramResult refused = rebake_run("recover " + in("j") + " --replace -o " + in("p.rebake"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.text.find("contains 2 edits, more than the 1"), std::string::npos) << refused.text;
  EXPECT_EQ(read_file(in("p.rebake")), project);
  EXPECT_TRUE(std::filesystem::exists(in("j")));
  EXPECT_EQ(rebake_run("recover " + in("j") + " -o " + in("q.rebake")).code, 0);
}

TEST_F(Cli, RecoverAcceptsEqualsSignsInPaths) {
  std::filesystem::rename(in("ball"), in("a=b"));
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("a=b") + "\"}\n" +
                            R"({"op": "hide", "node": 7})"
                            "\n",
                        {});
  ASSERT_NE(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 0);
  std::filesystem::rename(in("a=b"), in("c=d"));
  const ProgramResult found =
      rebake_run("recover " + in("j") + " -o " + in("p.rebake") + " --source " + in("a=b=") + in("c=d"));
  EXPECT_EQ(found.code, 0) << found.text;
}

TEST_F(Cli, RecoverFindsTheMovedSourcesOfAProject) {
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n" +
                            R"({"op": "save_project", "out": ")" + in("p.rebake") + R"("})" + "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl")).code, 0);
  std::filesystem::rename(in("ball"), in("moved"));
  const ProgramResult gone = rebake_run("info " + in("p.rebake"));
  EXPECT_NE(gone.text.find("rebake recover P.rebake --source OLD=NEW"), std::string::npos) << gone.text;
  const std::string relink = "recover " + in("p.rebake") + " --source " + in("ball=") + in("moved") + " -o ";
  const ProgramResult found = rebake_run(relink + in("q.rebake"));
  EXPECT_EQ(found.code, 0) << found.text;
  EXPECT_EQ(rebake_run("info " + in("q.rebake")).code, 0);
  EXPECT_TRUE(std::filesystem::exists(in("p.rebake")));
  EXPECT_EQ(rebake_run(relink + in("p.rebake")).code, 1) << "the project exists already";
  EXPECT_EQ(rebake_run(relink + in("p.rebake --replace")).code, 0);
  EXPECT_EQ(rebake_run("info " + in("p.rebake")).code, 0);
}

// Projects do not store undone edits: a journal that contains nothing else stays.
TEST_F(Cli, RecoverKeepsAJournalOfUndoneEdits) {
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n" + R"({"op": "undo"})" + "\n" +
                            R"({"op": "hide", "node": "nobody"})" + "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 1);
  const ProgramResult undone = rebake_run("recover " + in("j") + " -o " + in("p.rebake"));
  EXPECT_EQ(undone.code, 1);
  EXPECT_NE(undone.text.find("contains only undone edits, so no project is"), std::string::npos) << undone.text;
  EXPECT_TRUE(std::filesystem::exists(in("j")));
  EXPECT_FALSE(std::filesystem::exists(in("p.rebake")));
  write_file_atomically(in("torn"), read_file(in("j")).substr(0, 60), {});
  const ProgramResult torn = rebake_run("recover " + in("torn") + " -o " + in("p.rebake"));
  EXPECT_NE(torn.text.find("contains no complete edit: the program ended"), std::string::npos) << torn.text;
  const ProgramResult twice = rebake_run("recover " + in("j") + " -o " + in("p.rebake --source a=b --source ./a=c"));
  EXPECT_NE(twice.text.find("contains no source"), std::string::npos) << twice.text;
}

}  // namespace
}  // namespace rebake::test
