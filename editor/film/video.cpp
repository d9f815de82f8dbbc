#include "editor/film/video.h"

#include <fmt/format.h>

#include "mesh_ops/base/child_process.h"
#include "mesh_ops/base/error.h"

namespace rebake {

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
  add({"-metadata", fmt::format("comment={}", video_mark)});
  command.push_back(video.out.string());
  return command;
}

}  // namespace rebake
