#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Encoding of numbered pictures as a video by the program ffmpeg, which runs as a process of its own.
struct Video {
  std::filesystem::path pictures;  ///< pattern of their names in printf notation: "…/%05d.png"
  std::size_t count = 0;
  double fps = 25;
  std::string codec;         ///< encoder of ffmpeg; empty: libx264 for MP4, libvpx-vp9 for WebM
  bool transparent = false;  ///< keeps alpha; for WebM only
  std::filesystem::path out;
};

/// Text in the metadata of every encoded video, by which it is known as one of Rebake.
inline constexpr const char* video_mark = "Made by Rebake";

/// Whether a path names a video that can be written: .mp4 or .webm.
bool names_video(const std::filesystem::path& path);
/// Throws Error if ffmpeg is not installed, and FieldError for a transparent MP4.
void check_can_encode(const std::filesystem::path& out, bool transparent);
/// The command line, with colours converted by ITU-R BT.709 in limited range, as players expect.
std::vector<std::string> encoder_command(const Video& video);

}  // namespace rebake
