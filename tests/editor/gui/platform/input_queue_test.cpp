// Events per frame.
#include <gtest/gtest.h>

#include <deque>

#include "editor/gui/platform/input_queue.h"

namespace rebake::test {
namespace {

TEST(InputQueue, EachFrameSeesOneButtonChange) {
  using Kind = InputEvent::Kind;
  const auto shares = [](std::deque<InputEvent> waiting) {
    std::vector<std::size_t> result;
    while (!waiting.empty()) {
      result.push_back(events_of_frame(waiting));
      waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(result.back()));
    }
    return result;
  };
  const InputEvent move{Kind::move}, press{Kind::button, 0, 0, true}, release{Kind::button},
      key{Kind::key, 65, 0, true}, up{Kind::key, 65}, text{Kind::text, 'a'}, repeat{Kind::repeat, 65, 0, true},
      wheel{Kind::wheel};
  using Shares = std::vector<std::size_t>;
  EXPECT_EQ(shares({move, move, move}), Shares{3});
  EXPECT_EQ(shares({press, release}), (Shares{1, 1})) << "a click within one frame is seen";
  EXPECT_EQ(shares({move, press, move, move, release}), (Shares{2, 3})) << "and pressed at the pointer's position";
  EXPECT_EQ(shares({key, text, up, key, text, up}), (Shares{2, 1, 2, 1})) << "text stays with its key";
  EXPECT_EQ(shares({key, repeat, repeat, wheel, wheel}), Shares{5}) << "repeats must not delay frames";
  EXPECT_EQ(shares({move, wheel, move}), (Shares{2, 1})) << "the wheel zooms to the pointer's position";
}

}  // namespace
}  // namespace rebake::test
