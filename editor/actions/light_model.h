#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/light/train_transfer_model.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// The visible object of this name, or the only one if `name` is empty. Throws FieldError.
NodePtr object_for_light_model(const Scene& scene, const std::string& name);

/// Trains a model of the light transfer of a node's object as it was read. Each pose applies `edits` (JSON texts) with
/// random strengths between −1 and 1 times their own; the default of their field `node` is this node. Throws FieldError
/// for a faulty edit, Error if the object has no drag light.
TransferModel trained_light_model(const Scene& scene, const NodePtr& node, const std::vector<std::string>& edits,
                                  const TransferModelOptions& options, const Progress& progress);

/// Facts of a model for people, one line each: "error       4.3 % of transfer, …".
std::vector<std::string> facts_of(const TransferModel& model);

/// Whether drags are shaded better with the model than by rotation alone.
bool worth_using(const TransferModel& model);

/// Throws FileError if a model must not be written there.
void check_light_model_output(const std::filesystem::path& path, const SourceGuard& sources);

/// Reads a model file. Throws FileError.
TransferModel read_light_model(const std::filesystem::path& path);

/// Stores a model in the result cache for the object of the scene that it was trained for: drags of the object use it
/// from now on. Returns the object's node. `file`: of the model, for errors; empty: none. Throws Error if there is no
/// such object or no cache, or if the cache cannot store it; FileError if `file` is not empty.
NodePtr use_light_model(const TransferModel& model, const Scene& scene, const std::filesystem::path& file);

/// Has drags use a trained model if it is worth using, and writes it to `out` unless that is empty. Returns why drags
/// do not use it; empty: they do. Throws FileError, after which drags use it nevertheless; Error if nothing can store
/// it.
std::string store_light_model(const TransferModel& model, const Scene& scene, const std::filesystem::path& out,
                              const SourceGuard& sources);

/// Removes the model of a node's object from the cache. Returns whether there was one.
bool forget_light_model(const Scene& scene, const NodePtr& node, const Progress& progress);

}  // namespace rebake
