#include "editor/actions/film_action.h"

#include <fmt/format.h>

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "editor/actions/describe_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/views.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/support.h"
#include "editor/film/film_frames.h"
#include "editor/film/picture_folder.h"
#include "editor/film/video.h"
#include "mesh_ops/base/child_process.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/motion/scene_at.h"
#include "render/photograph_set.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

// Throws FieldError for fields that do not go together.
void check_fields(const FilmAction& action) {
  const bool video = names_video(action.out);
  if (action.out.empty()) throw FieldError("out", "is empty");
  if (const std::string extension = fs::path(action.out).extension().string();
      !video && (extension == ".mov" || extension == ".avi" || extension == ".mkv" || extension == ".gif"))
    throw FieldError("out", "videos are written as .mp4 and .webm; name such a file, or a folder for pictures");
  if (const std::string extension = fs::path(action.out).extension().string();
      extension == ".png" || extension == ".jpg" || extension == ".exr" || extension == ".webp")
    throw FieldError("out", "names a picture, but a film is many: name a folder, or a .mp4 or .webm file");
  if (video) check_can_encode(action.out, action.content.transparent);
  if (!video && !action.codec.empty()) throw FieldError("codec", "applies to videos only");
  if (video && action.picture != "png") throw FieldError("picture", "applies to folders only");
  if (action.picture != "png" && action.picture != "exr" && action.picture != "webp" && action.picture != "jpg")
    throw FieldError("picture", "must be png, exr, webp or jpg");
  if (!action.content.passes.empty() && (video || action.picture != "exr"))
    throw FieldError("passes", "are written to OpenEXR pictures: name a folder, and set picture to exr");
  check(action.content, "picture." + action.picture, action.width, action.height);
}

// A file in a temporary folder, both removed at the end.
struct TemporaryVideo {
  explicit TemporaryVideo(const fs::path& extension) {
    std::string name = (fs::temp_directory_path() / "rebake-video-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw FileError(name, "cannot be created");
    file = fs::path(name) / ("video" + extension.string());
  }
  ~TemporaryVideo() {
    std::error_code error;
    fs::remove_all(file.parent_path(), error);
  }
  TemporaryVideo(const TemporaryVideo&) = delete;
  TemporaryVideo& operator=(const TemporaryVideo&) = delete;
  fs::path file;
};

// Renders and writes the pictures of a film.
class Film {
 public:
  Film(Session& session, const FilmAction& action)
      : session_(session),
        action_(action),
        sources_(session.document.sources()),
        video_(names_video(action.out)),
        scene_(with_only(session.scene(), action.nodes)) {
    width_ = action.width;
    height_ = action.height;
    // Video in yuv420p needs even sizes.
    if (video_ && (width_ % 2 != 0 || height_ % 2 != 0)) {
      width_ += width_ % 2;
      height_ += height_ % 2;
      session.say(fmt::format("note: videos have even sizes: the film has {}×{} pixels", width_, height_));
    }
    // Also checks the size.
    const Scene first = has_keyframes(scene_) ? scene_at(scene_, 0) : scene_;
    start_ = resolve_view(first, action.camera, action.view, width_, height_, action.samples);
    // Planes that nobody gave are fitted to each picture.
    Camera start = start_.camera;
    if (!action.camera || action.camera->near_plane == 0 || action.camera->far_plane == 0)
      start.near_plane = start.far_plane = 0;
    FilmPath path{action.path, action.fps, action.seconds, action.loop, start, session.scene().ground.normal};
    std::vector<std::string> notes;
    frames_ = film_frames(scene_, path, fps_, notes);
    for (const std::string& note : notes) session.say("note: " + note);
  }

  void run() {
    const fs::path pictures = video_ ? fs::path(action_.out + ".pictures") : fs::path(action_.out);
    if (video_) {
      sources_.check_file(action_.out);
      refuse_replacing_work(action_.out);
      refuse_replacing_video(action_.out);
    }
    PictureFolder folder(pictures, video_ ? ".png" : "." + action_.picture, frames_.size(), content(), video_,
                         sources_);
    if (folder.removed() > 0)
      session_.say(fmt::format("note: replaced {} of an earlier film in {}", counted(folder.removed(), "picture"),
                               pictures.string()));
    std::vector<bool> exists(frames_.size());
    for (std::size_t k = 0; k < frames_.size(); ++k) exists[k] = folder.has(k);
    const auto known = static_cast<std::size_t>(std::count(exists.begin(), exists.end(), true));
    if (known > 0)
      session_.say(fmt::format("note: {} of {} {} already", known, counted(frames_.size(), "picture"),
                               known == 1 ? "exists" : "exist"));
    const auto start = Clock::now();
    std::size_t drawn = 0;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      if (exists[k]) continue;
      const double spent = std::chrono::duration<double>(Clock::now() - start).count();
      const std::string left =
          drawn < 3 ? std::string()
                    : fmt::format(", {} left", duration_text(spent / static_cast<double>(drawn) *
                                                             static_cast<double>(frames_.size() - known - drawn)));
      session_.progress.at(fmt::format("picture {} of {}{}", k + 1, frames_.size(), left),
                           static_cast<double>(k) / static_cast<double>(frames_.size()));
      folder.refuse_foreign(k);  // it may have appeared since
      draw(frames_[k], folder.picture(k));
      ++drawn;
    }
    if (video_) {
      encode(folder, pictures);
      folder.remove();
    }
    session_.outputs.push_back(action_.out);
    const std::string all = fmt::format("{} ({:.4g} s at {:.4g} per second)", counted(frames_.size(), "picture"),
                                        static_cast<double>(frames_.size()) / fps_, fps_);
    if (video_ || known == 0)
      session_.say(fmt::format("wrote {} to {}", all, action_.out));
    else
      session_.say(fmt::format("{}; {} holds the whole film now: {}",
                               drawn == 0 ? "wrote nothing" : "wrote " + counted(drawn, "picture"), action_.out, all));
  }

 private:
  // Everything that the pictures depend on.
  std::string content() const {
    ContentHash cameras;
    for (const FilmFrame& frame : frames_) {
      const Camera& c = frame.camera;
      cameras.add(fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {};", frame.seconds, c.eye.x(), c.eye.y(),
                              c.eye.z(), c.target.x(), c.target.y(), c.target.z(), c.up.x(), c.up.y(), c.up.z(),
                              c.fov_degrees, c.ortho_height, c.near_plane, c.far_plane, action_.samples));
    }
    std::string passes;
    for (const std::string& name : action_.content.passes) passes += " " + name;
    std::string scene = hash_text(picture_hash(scene_, session_.progress));
    // Objects that are not drawn still cast shadows.
    if (session_.scene().light != nullptr) scene += hash_text(picture_hash(session_.scene(), session_.progress));
    return fmt::format("scene {}, cameras {}, {}, {}x{}{}{}, passes{}", scene, hash_text(cameras.value()),
                       action_.picture, width_, height_, action_.content.transparent ? ", transparent" : "",
                       action_.content.panorama ? ", panorama" : "", passes);
  }

  void draw(const FilmFrame& frame, const fs::path& file) {
    // Nodes without keyframes are shared, so only what moves is uploaded again.
    const Scene moved = has_keyframes(scene_) ? scene_at(scene_, frame.seconds) : scene_;
    View view = start_;
    view.camera = fitted(moved, frame.camera, static_cast<double>(width_) / height_);
    check(view);
    // Objects that are not drawn still cast shadows.
    const bool moves = has_keyframes(session_.scene());
    if (!lighting_ || moves)
      lighting_ = lit(moves ? scene_at(session_.scene(), frame.seconds) : session_.scene(), session_.progress);
    render_to_file(session_.renderer(), moved, view, {}, &*lighting_, action_.content, file, sources_);
  }

  void encode(const PictureFolder& folder, const fs::path& pictures) const {
    // A file of its own outside of the pictures' folder, which holds nothing else.
    const TemporaryVideo partial(fs::path(action_.out).extension());
    ChildProcess encoder(encoder_command(
        {folder.pattern(), frames_.size(), fps_, action_.codec, action_.content.transparent, partial.file}));
    std::optional<int> status;
    while (!(status = encoder.ended())) {
      session_.progress.at("encoding the video", 1);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    if (*status != 0)
      throw Error(fmt::format("ffmpeg failed with exit status {}; no video was written. Its pictures are in {}",
                              *status, pictures.string()));
    refuse_replacing_video(action_.out);  // once more: it may have appeared since
    write_file_atomically(action_.out, with_video_mark(read_file(partial.file), action_.out), sources_);
  }

  Session& session_;
  const FilmAction& action_;
  SourceGuard sources_;
  bool video_;
  Scene scene_;
  View start_;
  int width_ = 0, height_ = 0;
  double fps_ = 25;
  std::vector<FilmFrame> frames_;
  std::optional<Lighting> lighting_;
};

}  // namespace

std::vector<fs::path> FilmAction::input_files(const nlohmann::json& object) {
  const auto path = object.find("path");
  if (path == object.end() || !path->is_string() || !is_camera_file(path->get<std::string>())) return {};
  return files_with_cameras(path->get<std::string>(), "");
}

void run(Session& session, const FilmAction& action) {
  check_fields(action);
  for (const fs::path& file : FilmAction::input_files({{"path", action.path}}))
    session.document.protect_file(file, "a camera file of this run, or a picture that it names");
  Film(session, action).run();
}

REBAKE_DESCRIBE_ACTION(
    FilmAction, "Renders a film of the scene, which moves by its keyframes.", (auto& action, auto& visit) {
      visit("out", action.out, Need::required,
            "folder for numbered pictures, or a video .mp4 or .webm, which the program ffmpeg encodes");
      visit("path", action.path, Need::optional,
            "way of the camera: keys (its keyframes), views (through all stored views), turntable, or a camera file "
            "(camera_path.json of nerfstudio, camera path of instant-ngp, transforms.json, COLMAP)");
      visit("view", action.view, Need::optional,
            "where the camera starts or stands without keyframes: name of a stored view; default: the camera, or one "
            "that frames the scene");
      visit("camera", action.camera, Need::optional, "where the camera starts or stands without keyframes");
      visit("fps", action.fps, Need::optional, "pictures per second; default: as the camera file states, or 25");
      visit("seconds", action.seconds, Need::optional,
            "length; default: up to the last keyframe, 2 s from view to view, 8 s around, 1 s per camera of a file");
      visit("loop", action.loop, Need::optional, "end where the film begins, without showing that picture twice");
      visit("width", action.width, Need::optional, "size of the pictures", Unit::pixels);
      visit("height", action.height, Need::optional, "size of the pictures", Unit::pixels);
      visit("samples", action.samples, Need::optional, "samples per pixel: 1, 4 or 16");
      PictureContent::fields(action.content, visit);
      visit("codec", action.codec, Need::optional, "encoder of ffmpeg; default: libx264 for MP4, libvpx-vp9 for WebM");
      visit("picture", action.picture, Need::optional, "format of the pictures in a folder: png, exr, webp or jpg");
      visit("nodes", action.nodes, Need::optional, "only these nodes and their children; default: all");
    })

}  // namespace rebake
