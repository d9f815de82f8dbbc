#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/codec.h"
#include "editor/fields/values.h"
#include "mesh_ops/light/train_transfer_model.h"

namespace rebake {

/// Method of a model of light transfer: linear in the pose; a U-Net (UnetTransfer); that of deep precomputed radiance
/// transfer as published (DprtTransfer).
enum class LightModelWay { linear, net, published };
template <>
struct Codec<LightModelWay> {
  static FieldType type();
  static LightModelWay read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(const LightModelWay& value);
};

/// Trains a model of an object's light transfer, which shades drags of it. The scene stays as it is.
struct TrainLightAction {
  static constexpr const char* op = "train_light";
  std::optional<NodeRef> node;       ///< nothing: the only object
  std::optional<PosingEdits> edits;  ///< nothing: the deformations of the object in the history
  int poses = 200, rays = 128;
  LightModelWay way = LightModelWay::linear;
  int channels = 8;          ///< networks: of the first layer
  double coarseness = 0.03;  ///< networks: of the proxy body, a share of the object's diagonal
  std::string out;           ///< also write the model to this file

  /// Files that the edits read.
  static std::vector<std::filesystem::path> input_files(const nlohmann::json& object);
};
template <>
const ActionType& action_type<TrainLightAction>();
template <>
TrainLightAction read_action<TrainLightAction>(const nlohmann::json& object, const Scene& scene);

/// Size and effort of the training. Throws FieldError for values out of range.
TransferModelOptions training_options(const TrainLightAction& action);

/// Throws FieldError, FileError, and Error for objects without drag light; see trained_light_model().
void run(Session& session, const TrainLightAction& action);

}  // namespace rebake
