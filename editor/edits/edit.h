#pragma once

#include <concepts>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

class Edit;
struct FieldLine;

/// What an edit did, in sentences for people.
struct Report {
  std::vector<std::string> lines;
};

/// What an edit makes of a scene.
struct Outcome {
  Scene scene;
  Report report;

  Outcome(Scene made) : scene(std::move(made)) {}  // most have nothing to say
  Outcome(Scene made, Report said) : scene(std::move(made)), report(std::move(said)) {}
};

/// A kind of edit: a line of the one table (table.cpp). Each is a struct of its own, described in its own file by
/// REBAKE_DESCRIBE_EDIT (describe.h); nobody else knows its fields' names.
struct EditType {
  const char* op;    ///< its name in scripts, journals and Python
  const char* help;  ///< one sentence
  bool selects;      ///< it does nothing but change the selection

  std::vector<FieldLine> (*fields)();
  Edit (*read)(const nlohmann::json& object, const Scene& scene);
  nlohmann::json (*write)(const void* edit);
  Outcome (*apply)(const Scene& scene, const void* edit, const Progress& progress);
  std::vector<NodeId> (*named_nodes)(const void* edit);
};

/// The type of an edit's struct; each specialises this.
template <class T>
const EditType& edit_type();

/// Anything that changes a scene, as data: a value of one of the structs in the table.
class Edit {
 public:
  template <class T>
  requires requires { T::op; }
  Edit(T edit) : type_(&edit_type<T>()), value_(std::make_shared<const T>(std::move(edit))) {}

  const EditType& type() const { return *type_; }
  /// Null when it is another kind of edit.
  template <class T>
  const T* as() const {
    return type_ == &edit_type<T>() ? static_cast<const T*>(value_.get()) : nullptr;
  }
  template <class T>
  bool is() const {
    return as<T>() != nullptr;
  }
  const void* value() const { return value_.get(); }

 private:
  const EditType* type_;
  std::shared_ptr<const void> value_;
};

/// All kinds of edits, in the order of help.
std::span<const EditType* const> edit_types();

/// Pure and deterministic: the scene after the edit, and what it did. Throws Error and leaves nothing changed;
/// Cancelled when `progress` says so.
Outcome carry_out(const Scene& scene, const Edit& edit, const Progress& progress);
/// The same. For an Edit only: no edit's own struct becomes one here, so that each is found by its own apply().
template <std::same_as<Edit> E>
Outcome apply(const Scene& scene, const E& edit, const Progress& progress = {}) {
  return carry_out(scene, edit, progress);
}

/// Reads an edit from its JSON object. Names of nodes are looked up in `scene`. Throws FieldError.
Edit read_edit(const nlohmann::json& object, const Scene& scene);

/// One JSON object, node numbers in place of names.
nlohmann::json to_json(const Edit& edit);

}  // namespace rebake
