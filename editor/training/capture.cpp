#include "editor/training/capture.h"

#include <fmt/format.h>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "render/photograph_set.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The source of the photographs that are held out by a file of their own.
std::optional<PhotographSource> held_out_source(const PhotographSource& source, const HeldOut& held_out) {
  PhotographSource other = source;
  if (!held_out.file.empty()) {
    other.path = held_out.file;
    other.format.clear();
    return other;
  }
  const fs::path file = camera_root(source.path, source.format);
  std::error_code error;
  if (file.filename() != "transforms_train.json") return std::nullopt;
  other.path = file.parent_path() / "transforms_test.json";
  if (!fs::exists(other.path, error)) return std::nullopt;
  return other;
}

void add_notes(Capture& capture, const PhotographSet& set, std::size_t cameras, const char* which) {
  const auto photographs = [which](std::size_t number) { return counted(number, fmt::format("{} photograph", which)); };
  if (set.missing > 0)
    capture.notes.push_back(fmt::format("warning: {} of {} missing, the first is \"{}\"", set.missing,
                                        photographs(cameras), set.first_missing));
  if (set.masked > 0) capture.notes.push_back("warning: masks leave out all of " + photographs(set.masked));
  if (set.resampled > 0)
    capture.notes.push_back(fmt::format("note: {} {} resampled without distortion and off-centre principal points",
                                        photographs(set.resampled), set.resampled == 1 ? "was" : "were"));
}

void add_hash(ContentHash& hash, const PhotoCamera& camera, const FitPhotograph& photograph) {
  hash.add(fmt::format("{} {} {} {}", camera.name, photograph.width, photograph.height, photograph.camera.fov_degrees));
  for (const double value : {camera.eye.x(), camera.eye.y(), camera.eye.z(), camera.near_plane, camera.far_plane})
    hash.add(fmt::format(" {}", value));
  for (const double value : camera.axes.reshaped()) hash.add(fmt::format(" {}", value));
  hash.add({reinterpret_cast<const char*>(photograph.rgb.data()), photograph.rgb.size()});
  hash.add({reinterpret_cast<const char*>(photograph.valid.data()), photograph.valid.size()});
}

}  // namespace

Capture read_capture(const PhotographSource& source, const HeldOut& held_out, const Vec3& background,
                     const Progress& progress) {
  Capture capture;
  capture.source = source;
  const auto read = [&](const PhotographSource& from, const char* which) {
    std::vector<std::string> notes;
    const std::vector<PhotoCamera> cameras = read_cameras(from, notes);
    for (const PhotoCamera& camera : cameras)
      if (!camera.eye.allFinite() || !camera.axes.allFinite())
        throw FileError(from.path, "the camera of \"" + camera.name + "\" has a position that is not a number");
    for (const std::string& note : notes)
      capture.notes.push_back(fmt::format("note: {}: {}", from.path.string(), note));
    PhotographSet set = read_photographs(from, cameras, background, progress);
    add_notes(capture, set, cameras.size(), which);
    return set;
  };
  PhotographSet training = read(source, "training");
  const std::optional<PhotographSource> own_held_out = held_out_source(source, held_out);
  if (own_held_out) capture.held_out = read(*own_held_out, "held-out").photographs;
  const std::size_t count = training.photographs.size(), every = static_cast<std::size_t>(std::max(0, held_out.every));
  // A few photographs are all needed for training.
  const bool split = !own_held_out && every > 1 && count >= every;
  ContentHash hash;
  for (std::size_t k = 0; k < count; ++k) {
    if (split && k % every == 0) {
      capture.held_out.push_back(std::move(training.photographs[k]));
      continue;
    }
    FitPhotograph photograph = for_fit(std::move(training.photographs[k]));
    add_hash(hash, training.cameras[k], photograph);
    capture.cameras.push_back(training.cameras[k]);
    capture.training.push_back(std::move(photograph));
  }
  if (split)
    capture.notes.push_back(
        fmt::format("note: every {}th photograph is held out to judge the result, from the first on", every));
  else if (!own_held_out)
    capture.notes.emplace_back("note: no photograph is held out; the result is not judged");
  capture.hash = hash.value();
  return capture;
}

std::vector<fs::path> files_of_capture(const PhotographSource& source, const HeldOut& held_out) {
  std::vector<fs::path> files = files_with_cameras(source.path, source.format);
  if (const auto other = held_out_source(source, held_out))
    for (fs::path& file : files_with_cameras(other->path, other->format)) files.push_back(std::move(file));
  return files;
}

}  // namespace rebake
