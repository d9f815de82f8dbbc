#pragma once

#include <filesystem>
#include <string>
#include <string_view>
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

/// The bytes of an encoded video with an ending that names Rebake and holds a hash of them, and that players skip: a
/// box `free` (ISO/IEC 14496-12, section 8.1.2) or an element Void (RFC 8794, section 11.3.1). Programs that cut or
/// convert videos drop it. `out`: by whose extension the container is known.
std::string with_video_mark(std::string video, const std::filesystem::path& out);
/// Whether these are the bytes that with_video_mark() gave.
bool is_marked_video(std::string_view bytes);
/// Throws FileError if there is a file that is not a marked video.
void refuse_replacing_video(const std::filesystem::path& file);

/// Whether a path names a video that can be written: .mp4 or .webm.
bool names_video(const std::filesystem::path& path);
/// Throws Error if ffmpeg is not installed, and FieldError for a transparent MP4.
void check_can_encode(const std::filesystem::path& out, bool transparent);
/// The command line, with colours converted by ITU-R BT.709 in limited range, as players expect.
std::vector<std::string> encoder_command(const Video& video);

}  // namespace rebake
