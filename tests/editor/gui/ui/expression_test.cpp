// Arithmetic in number fields.
#include <gtest/gtest.h>

#include "editor/gui/ui/expression.h"

namespace rebake::test {
namespace {

TEST(Expression, EvaluatesArithmetic) {
  EXPECT_EQ(evaluated("90/4 + 1"), 23.5);
  EXPECT_EQ(evaluated(" -(2+3)*2 "), -10);
  EXPECT_EQ(evaluated("2-3-4"), -5);
  EXPECT_EQ(evaluated("1e-3*-2"), -0.002);
  EXPECT_NEAR(*evaluated("pi/2"), 1.5707963267948966, 1e-15);
  for (const char* text : {"", "1+", "(1", "1/0", "x", "1 2", "--"}) EXPECT_FALSE(evaluated(text)) << text;
  EXPECT_FALSE(evaluated(std::string(100000, '('))) << "however deep";
}

}  // namespace
}  // namespace rebake::test
