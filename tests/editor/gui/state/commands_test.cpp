// Keyboard shortcuts: names, and both keymaps.
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "editor/gui/state/commands.h"

namespace rebake::test {
namespace {

TEST(Keys, ParsesKeyNames) {
  EXPECT_EQ(parse_key("R"), (KeyPress{GLFW_KEY_R}));
  EXPECT_EQ(parse_key("Ctrl+Shift+Z"), (KeyPress{GLFW_KEY_Z, true, true, false}));
  EXPECT_EQ(parse_key("["), (KeyPress{GLFW_KEY_LEFT_BRACKET}));
  EXPECT_EQ(parse_key("F12"), (KeyPress{GLFW_KEY_F12}));
  EXPECT_EQ(parse_key("KP_7"), (KeyPress{GLFW_KEY_KP_7}));
  EXPECT_EQ(parse_key("Alt+Delete"), (KeyPress{GLFW_KEY_DELETE, false, false, true}));
  for (const char* text : {"", "Ctrl+", "F13", "KP_X", "rr", "Shift"}) EXPECT_FALSE(parse_key(text)) << text;
}

TEST(Keys, KeymapsContainValidUniqueKeys) {
  for (const bool blender : {false, true}) {
    std::set<std::string> taken;
    for (const Command& command : command_table()) {
      std::istringstream keys(blender ? command.blender_keys : command.keys);
      for (std::string key; keys >> key;) {
        EXPECT_TRUE(parse_key(key)) << key;
        EXPECT_TRUE(taken.insert(key).second) << key << " is assigned twice, also to " << command.title;
      }
    }
  }
}

}  // namespace
}  // namespace rebake::test
