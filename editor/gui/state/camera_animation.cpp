#include "editor/gui/state/camera_animation.h"

#include <fmt/format.h>
#include <unistd.h>

#include "editor/document/replaced_work.h"
#include "editor/film/video.h"
#include "editor/gui/state/settings.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "render/image.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

std::string name_of(std::size_t picture) { return fmt::format("{:03}.png", picture); }

// Throws FileError if the picture would replace anything but a picture of an earlier animation, or count as a film's.
void refuse_other_picture(const fs::path& picture) {
  refuse_replacing_work(picture);
  std::error_code error;
  if (!fs::exists(fs::symlink_status(picture, error))) return;
  if (fs::is_symlink(picture, error) || !is_rendered_picture(picture))
    throw FileError(picture,
                    "exists and was not rendered by Rebake, was changed since, is of an earlier build, or is a link; "
                    "choose a new folder");
  refuse_replacing_captured(picture);
}

void refuse_other_pictures(const fs::path& folder, std::size_t count) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw FileError(folder, "is a file; name a folder, or a .mp4 file");
  for (std::size_t k = 0; k < count; ++k) refuse_other_picture(folder / name_of(k));
}

}  // namespace

CameraAnimation::CameraAnimation(fs::path out, int width, int height, std::vector<Camera> cameras,
                                 const SourceGuard& sources)
    : out_(std::move(out)), width_(width), height_(height), cameras_(std::move(cameras)) {
  if (out_.extension() != ".mp4") {
    sources.check_folder(out_);
    refuse_other_pictures(out_, cameras_.size());
    pictures_ = out_;
  } else {
    sources.check_file(out_);
    refuse_replacing_work(out_);
    refuse_replacing_video(out_);
    check_can_encode(out_, false);
    pictures_ = cache_folder() / fmt::format("film-{}", ::getpid());
    std::error_code nothing;
    fs::remove_all(pictures_, nothing);  // left by an editor with the same process id that was killed
    // Video in yuv420p needs even sizes.
    width_ += width_ % 2;
    height_ += height_ % 2;
  }
  std::error_code failed;
  fs::create_directories(pictures_, failed);
  if (failed) throw FileError(pictures_, "cannot be created: " + failed.message());
}

CameraAnimation::~CameraAnimation() {
  encoder_.reset();
  std::error_code gone;
  if (video()) fs::remove_all(pictures_, gone);
}

std::string CameraAnimation::doing() const {
  return encoder_ ? "Encoding the video" : fmt::format("Picture {} of {}", next_ + 1, cameras_.size());
}

std::string CameraAnimation::run_step(const std::function<void(const Camera&, const fs::path&)>& write,
                                      const SourceGuard& sources) {
  const fs::path partial = pictures_ / "video.mp4";
  if (next_ < cameras_.size()) {
    if (!video()) refuse_other_picture(pictures_ / name_of(next_));  // it may have appeared since
    write(cameras_[next_], pictures_ / name_of(next_));
    if (++next_ < cameras_.size()) return "";
    if (!video()) return fmt::format("Wrote {} to {}", counted(cameras_.size(), "picture"), out_.string());
    encoder_ = std::make_unique<ChildProcess>(
        encoder_command({pictures_ / "%03d.png", cameras_.size(), rate, "", false, partial}));
    return "";
  }
  const std::optional<int> status = encoder_->ended();
  if (!status) return "";
  if (*status != 0) throw Error(fmt::format("ffmpeg failed with exit status {}; no video was written", *status));
  refuse_replacing_video(out_);  // once more: it may have appeared since
  write_file_atomically(out_, with_video_mark(read_file(partial), out_), sources);
  return fmt::format("Wrote {} seconds of video to {}", static_cast<double>(cameras_.size()) / rate, out_.string());
}

std::string CameraAnimation::stopped() const {
  if (video()) return "Cancelled: no video was written";
  return fmt::format("Cancelled: wrote {} of {} to {}", next_, counted(cameras_.size(), "picture"), out_.string());
}

}  // namespace rebake
