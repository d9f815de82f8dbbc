#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"
#include "mesh_ops/reconstruction/grid_space.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Trains a scene from photographs with known cameras and writes it as a MobileNeRF folder. The document stays as it
/// is.
struct TrainAction {
  static constexpr const char* op = "train";
  std::string photographs;        ///< camera file or folder of a capture
  std::string out;                ///< folder to write
  CaptureKind kind{};             ///< object
  std::optional<double> minutes;  ///< about how long it may take
  std::optional<int> steps;       ///< number of steps; nothing: by `minutes`, else 17000
  std::optional<int> side;        ///< cells per side of the grid
  std::optional<double> near;     ///< forward: nearest depth
  std::optional<double> far;      ///< forward: farthest depth
  int seed = 1;
  std::string fields = "hash";              ///< hash or mlp
  int width = 64, octaves = 6, layers = 4;  ///< mlp: of the published networks
  CameraFormatName format;                  ///< empty: recognised
  std::optional<WorldUp> world;             ///< as for import_views
  double scale = 1;                         ///< factor of the cameras' positions
  std::string held_out;                     ///< camera file of photographs to judge the result by
  int hold_out = 8;                         ///< every n-th photograph judges the result; 0: none
  bool one_exposure = false;                ///< no gains per photograph
  bool one_ray = false;                     ///< one ray per pixel in stage 2
  int samples = 16;                         ///< texels between the corners of a quad
  bool fresh = false;                       ///< starts again instead of going on from a checkpoint

  /// The camera files and the photographs.
  static std::vector<std::filesystem::path> input_files(const nlohmann::json& object);
};
template <>
const ActionType& action_type<TrainAction>();
template <>
TrainAction read_action<TrainAction>(const nlohmann::json& object, const Scene& scene);

/// The scene of a training at one moment.
struct TrainingPreview {
  std::shared_ptr<const BakedObject> object;  ///< with coarse textures; null: nothing is opaque yet
  std::vector<std::array<double, 3>> rows;  ///< steps, seconds, PSNR in dB of the training pixels since the row before
  std::vector<PhotoCamera> cameras;         ///< of the photographs
};

/// Watches and ends a running training. All functions are called on its thread; each may be empty.
struct TrainingObserver {
  std::function<void(const TrainingPreview&)> preview;  ///< from time to time, at most a tenth of the time
  std::function<bool()> enough;                         ///< whether to leave out the rest of the steps
  std::function<SourceGuard()> more_sources;            ///< files and folders that must not be overwritten
  bool may_replace = true;  ///< whether an output folder that has contents at the start may be replaced
  /// Whether a training that is to stop goes on instead, because its checkpoint cannot be written.
  std::function<bool(const std::string& problem)> goes_on_unsaved;
};

/// Throws FieldError, FileError, Error for captures that cannot be trained on, and Cancelled; then a checkpoint stays.
void run(Session& session, const TrainAction& action, const TrainingObserver& observer);
inline void run(Session& session, const TrainAction& action) { run(session, action, {}); }

}  // namespace rebake
