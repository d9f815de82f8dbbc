#include "editor/cli/help_pages.h"

#include <gtest/gtest.h>

namespace rebake {
namespace {

// A subcommand with everything that needs quoting.
std::vector<SubcommandHelp> tricky() {
  SubcommandHelp help{"draw", "draws [one] picture: a:b", ".begins like a request", {}};
  help.options.push_back({"folder", "FOLDER", "folder", {}});
  help.options.push_back({"-o,--out", "OUT.png", "the picture's file \\ path", {}});
  help.options.push_back({"--mode", "WORD", "mode", {"fast", "slow"}});
  help.options.push_back({"--json", "", "print JSON", {}});
  return {help};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(HelpPages, ManualEscapesRequestsDashesAndBackslashes) {
  const std::string page = manual_page(tricky(), "rebake 1.0");
  EXPECT_TRUE(contains(page, ".SS rebake draw\n"));
  EXPECT_TRUE(contains(page, "\\fB\\-o\\fR, \\fB\\-\\-out\\fR \\fIOUT.png\\fR\nthe picture's file \\e path\n")) << page;
  EXPECT_TRUE(contains(page, "\n\\&.begins like a request\n"));
  EXPECT_TRUE(contains(page, "\\fIWORD\\fR\nmode; one of: fast, slow\n")) << page;
}

TEST(HelpPages, BashOffersOptionsAndAllowedWords) {
  const std::string script = bash_completion(tricky());
  EXPECT_TRUE(contains(script, "draw) options='--help -o --out --mode --json' ;;"));
  EXPECT_TRUE(contains(script, "draw:--mode) words='fast slow' ;;"));
}

TEST(HelpPages, ZshEscapesBracketsColonsAndQuotes) {
  const std::string script = zsh_completion(tricky());
  EXPECT_TRUE(contains(script, "'draw:draws [one] picture: a:b'"));
  EXPECT_TRUE(contains(script, "'--out[the picture'\\''s file \\\\ path]:OUT.png:_files'")) << script;
  EXPECT_TRUE(contains(script, "'--mode[mode]:WORD:(fast slow)'"));
  EXPECT_TRUE(contains(script, "'--json[print JSON]'"));
}

TEST(HelpPages, FishMarksOptionsThatTakeAValue) {
  const std::string script = fish_completion(tricky());
  EXPECT_TRUE(contains(script, " -s o -l out -r -d 'the picture'\\''s file"));
  EXPECT_TRUE(contains(script, " -l json -d 'print JSON'"));
}

TEST(HelpPages, DescribeEverySubcommand) {
  const std::vector<SubcommandHelp> all = subcommand_help();
  ASSERT_GE(all.size(), 10u);
  for (const SubcommandHelp& subcommand : all) {
    EXPECT_FALSE(subcommand.options.empty()) << subcommand.name;
    for (const OptionHelp& option : subcommand.options) EXPECT_FALSE(option.help.empty()) << option.names;
  }
}

}  // namespace
}  // namespace rebake
