#include "editor/cli/film_options.h"

#include "editor/actions/film_action.h"
#include "editor/cli/terminal.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void FilmOptions::add_to(SubcommandDescription& command) {
  command.option(
      "--path", path,
      "film: the camera follows its keyframes (keys), all stored views (views), a circle (turntable), or a "
      "camera file (nerfstudio, instant-ngp, COLMAP, transforms.json); -o names a folder, or a .mp4 or .webm "
      "file. A film that was interrupted goes on",
      "keys|views|turntable|FILE");
  command.option("--fps", fps, "film: pictures per second", "n [25, or as the file states]");
  command.option("--seconds", seconds,
                 "film: length; default: up to the last keyframe, 2 s from view to view, 8 s around, 1 s per camera",
                 "n");
  command.flag("--loop", loop, "film: end where it begins, without showing that picture twice");
  command.option("--codec", codec, "film: encoder of ffmpeg", "NAME [libx264 for .mp4, libvpx-vp9 for .webm]");
  command.option("--picture", picture, "film: format of the pictures in a folder", "png|exr|webp|jpg [png]")
      .one_of({"png", "exr", "webp", "jpg"});
}

void FilmOptions::check_unused() const {
  for (const auto& [given, name] : {std::pair(fps.has_value(), "--fps"),
                                    {seconds.has_value(), "--seconds"},
                                    {loop, "--loop"},
                                    {!codec.empty(), "--codec"},
                                    {!picture.empty(), "--picture"}})
    if (given) throw FieldError(name, "applies to films: add --path");
}

void FilmOptions::render(LoadedScene opened, const ViewOptions& view, const PictureContent& content,
                         const std::string& out) const {
  if (out.empty()) throw FieldError("-o", "is missing: name a folder, or a .mp4 or .webm file");
  if (content.separate) throw FieldError("--separate", "does not apply to films: each picture holds all its passes");
  for (const auto& [given, name] : {std::pair(view.weights != ViewOptions().weights, "--weights"),
                                    {view.shading != ViewOptions().shading, "--shading"},
                                    {view.precision != ViewOptions().precision, "--precision"},
                                    {view.occlusion != ViewOptions().occlusion, "--occlusion"},
                                    {view.texels != ViewOptions().texels, "--texels"}})
    if (given) throw FieldError(name, "cannot be combined with --path");
  opened.sources.check_folder(out);
  FilmAction action;
  const View start = view.view(opened.scene);
  action.out = out;
  action.path = path;
  action.camera = start.camera;
  // The framing's planes fit the scene as it stands; those of a film are fitted to each picture.
  if (view.camera_file.empty() && !view.near_plane && !view.far_plane)
    action.camera->near_plane = action.camera->far_plane = 0;
  action.fps = fps;
  action.seconds = seconds;
  action.loop = loop;
  action.width = start.width;
  action.height = start.height;
  action.samples = start.samples;
  action.codec = codec;
  if (!picture.empty()) action.picture = picture;
  action.content = content;
  Session session;
  session.progress = progress_bar();
  session.say = print_message;
  session.document = Document(std::move(opened.scene));
  session.document.protect_all(opened.sources);
  run(session, action);
}

}  // namespace rebake
