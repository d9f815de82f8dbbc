// The mark of encoded videos.
#include "editor/film/video.h"

#include <gtest/gtest.h>

namespace rebake::test {
namespace {

using namespace std::string_literals;

const std::string webm_start = "\x1a\x45\xdf\xa3\x80\x18\x53\x80\x67\x01"s;

TEST(Video, MarksBecomePartOfASegmentOfKnownSize) {
  const std::string marked = with_video_mark(webm_start + "\0\0\0\0\0\1\xf0"s + std::string(0x1f0, 'x'), "a.webm");
  EXPECT_EQ(marked.substr(webm_start.size(), 7), "\0\0\0\0\0\2\x11"s) << "33 bytes more";
  EXPECT_EQ(marked.size(), webm_start.size() + 7 + 0x211);
  EXPECT_TRUE(is_marked_video(marked));
}

TEST(Video, SegmentsOfUnknownSizeStay) {
  const std::string unknown(7, '\xff');
  const std::string marked = with_video_mark(webm_start + unknown + "frames", "a.webm");
  EXPECT_TRUE(marked.starts_with(webm_start + unknown + "frames"));
  EXPECT_TRUE(is_marked_video(marked));
}

TEST(Video, ShortOnesGetMarksToo) {
  for (const char* name : {"a.webm", "a.mp4"})
    for (const std::string& video : {""s, "x"s, webm_start, webm_start + "\0\0"s}) {
      EXPECT_FALSE(is_marked_video(video));
      const std::string marked = with_video_mark(video, name);
      EXPECT_TRUE(is_marked_video(marked));
      EXPECT_FALSE(is_marked_video(marked + "x"));
      EXPECT_FALSE(is_marked_video("x" + marked));
    }
}

}  // namespace
}  // namespace rebake::test
