#include "editor/film/video.h"

#include <fmt/format.h>

#include <cstdint>

#include "mesh_ops/base/child_process.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

namespace {

// Adds a size to that of the segment of a WebM file, if it is known (RFC 8794, section 6.2), so that the mark is part
// of it.
void lengthen_segment(std::string& webm, std::size_t more) {
  constexpr std::string_view segment = "\x18\x53\x80\x67\x01";  // followed by a size of seven bytes
  const std::size_t at = webm.find(segment);
  if (at == std::string::npos || webm.size() < at + segment.size() + 7) return;
  std::uint64_t size = 0;
  for (std::size_t k = 0; k < 7; ++k)
    size += std::uint64_t{static_cast<unsigned char>(webm[at + segment.size() + 6 - k])} << 8 * k;
  constexpr std::uint64_t unknown = (std::uint64_t{1} << 56) - 1;
  if (size == unknown) return;
  size += more;
  for (std::size_t k = 0; k < 7; ++k) webm[at + segment.size() + 6 - k] = static_cast<char>(size >> 8 * k & 255U);
}

std::string mark_text(std::string_view video) { return "Made by Rebake " + hash_text(content_hash(video)); }

}  // namespace

bool names_video(const std::filesystem::path& path) {
  return path.extension() == ".mp4" || path.extension() == ".webm";
}

void check_can_encode(const std::filesystem::path& out, bool transparent) {
  if (transparent && out.extension() != ".webm")
    throw FieldError("transparent", "MP4 has no alpha; name a .webm file, or a folder for pictures");
  if (program_path("ffmpeg").empty())
    throw Error("a video needs the program ffmpeg, which is not installed; install it, or name a folder for pictures");
}

std::vector<std::string> encoder_command(const Video& video) {
  const bool webm = video.out.extension() == ".webm";
  std::vector<std::string> command{program_path("ffmpeg"),
                                   "-nostdin",
                                   "-xerror",
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-framerate",
                                   fmt::format("{}", video.fps),
                                   "-i",
                                   video.pictures.string(),
                                   "-frames:v",
                                   std::to_string(video.count)};
  const auto add = [&](std::initializer_list<std::string> more) { command.insert(command.end(), more); };
  add({"-vf", "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709", "-color_primaries", "bt709",
       "-color_trc", "bt709", "-color_range", "tv"});
  add({"-pix_fmt", video.transparent ? "yuva420p" : "yuv420p"});
  add({"-c:v", !video.codec.empty() ? video.codec : webm ? "libvpx-vp9" : "libx264"});
  // Constant quality, hardly distinguishable from the pictures.
  if (video.codec.empty() && webm) add({"-crf", "18", "-b:v", "0", "-row-mt", "1"});
  if (video.codec.empty() && !webm) add({"-crf", "16", "-movflags", "+faststart"});
  add({"-metadata", "comment=Made by Rebake"});
  command.push_back(video.out.string());
  return command;
}

std::string with_video_mark(std::string video, const std::filesystem::path& out) {
  const std::size_t size = mark_text("").size();
  std::string head = std::string(3, '\0') + static_cast<char>(8 + size) + "free";
  if (out.extension() == ".webm") {
    head = std::string("\xec") + static_cast<char>(0x80 | size);
    lengthen_segment(video, head.size() + size);
  }
  const std::string text = mark_text(video);
  video += head;
  video += text;
  return video;
}

bool is_marked_video(std::string_view bytes) {
  const std::size_t size = mark_text("").size();
  for (const std::size_t before : {std::size_t{8}, std::size_t{2}}) {
    if (bytes.size() < before + size) continue;
    const std::string_view video = bytes.substr(0, bytes.size() - before - size);
    if (bytes.substr(bytes.size() - size) == mark_text(video)) return true;
  }
  return false;
}

void refuse_replacing_video(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error) || std::filesystem::file_size(file, error) == 0) return;
  if (!is_marked_video(read_file(file)))
    throw FileError(
        file, "exists and is not a video of Rebake, was changed since, or is of an earlier build; choose another name");
}

}  // namespace rebake
