// Numbers typed during a drag.
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include "editor/gui/tools/typed_number.h"

namespace rebake::test {
namespace {

TEST(TypedNumber, IsAnExpression) {
  TypedNumber number;
  const auto type = [&](std::initializer_list<int> keys) {
    for (const int key : keys) EXPECT_TRUE(number.key({key})) << key;
  };
  EXPECT_FALSE(number.value());
  type({GLFW_KEY_MINUS});
  EXPECT_FALSE(number.value()) << "half typed";
  type({GLFW_KEY_3, GLFW_KEY_SLASH});
  EXPECT_EQ(number.value(), -3.0) << "the last complete number stays valid";
  type({GLFW_KEY_KP_4});
  EXPECT_EQ(number.value(), -0.75);
  type({GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE});
  EXPECT_FALSE(number.value()) << "without text the pointer applies again";
  EXPECT_FALSE(number.key({GLFW_KEY_X}));
  EXPECT_FALSE(number.key({GLFW_KEY_1, false, true})) << "Ctrl is for commands";
}

}  // namespace
}  // namespace rebake::test
