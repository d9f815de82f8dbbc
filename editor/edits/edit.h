#pragma once

#include <concepts>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

class Edit;
struct FieldInfo;

/// Messages for users about the effect of an edit.
struct Report {
  std::vector<std::string> lines;
};

/// Result of an edit.
struct Outcome {
  Scene scene;
  Report report;

  Outcome(Scene made) : scene(std::move(made)) {}  // most edits report nothing
  Outcome(Scene made, Report said) : scene(std::move(made)), report(std::move(said)) {}
};

/// External input of an edit, such as an imported folder.
struct EditSource {
  std::filesystem::path path;  ///< empty: none
  std::string content;         ///< content hash, hexadecimal; may be empty
};

/// A field that can be adjusted after the edit. Forms of its value: `number`: a whole number of at least 1; `length`:
/// scene units (a field "falloff" is not negative); `factor`: 1 is neutral; `rotation`: a quaternion; `factors`: a
/// scale per axis.
struct AdjustableField {
  enum class Kind { number, length, degrees, factor, point, factors, rotation };
  const char* field;  ///< its name in JSON
  const char* label;
  Kind kind;
};

struct SceneChange;

/// Type-erased description of one kind of edit; table.cpp lists all. Each kind is a struct in its own file, described
/// there by REBAKE_DESCRIBE_EDIT (describe_edit.h), the only place that names its fields.
struct EditType {
  const char* op;    ///< name in scripts, journals and Python
  const char* help;  ///< one sentence
  bool selects;      ///< changes nothing but the selection

  // For the window. Structs state them as static members of the same names, or by functions.
  bool needs_selection;  ///< without selected triangles it does nothing
  bool makes_nodes;      ///< adds nodes, which are then picked
  bool deforms;          ///< deforms triangles, which its title counts
  std::span<const AdjustableField> adjustable;
  /// Verb in the past tense for titles of steps: "Hid", "Bent by 20°:". Given by a function done_words(edit), or by
  /// T::done. Without both, it is made from `op`.
  std::string (*done)(const void* edit);
  /// The title of a step with this edit: a function whole_title(edit). Empty: the title is `done` and what changed.
  std::string (*title)(const void* edit);
  /// The title of a step from what changed: a function change_title(edit, change, replaced), where `replaced` is the
  /// edit of the same kind that this one revises, or null. Empty: as above.
  std::string (*change_title)(const void* edit, const SceneChange& change, const void* replaced);

  std::vector<FieldInfo> (*fields)();  ///< names, types, defaults and help
  /// The functions below as read_edit(), to_json() and apply(); `edit` points to the struct.
  Edit (*read)(const nlohmann::json& object, const Scene& scene);
  nlohmann::json (*write)(const void* edit);
  Outcome (*apply)(const Scene& scene, const void* edit, const Progress& progress);
  /// Nodes in the edit's fields.
  std::vector<NodeId> (*named_nodes)(const void* edit);

  // For edits that read an external input; otherwise null. Structs state them as a static member `source_field` and as
  // functions input() and set_input().
  const char* source_field;                ///< the field with its path; the field "content" has its hash
  EditSource (*source)(const void* edit);  ///< with an empty path if this edit reads none
  Edit (*with_source)(const void* edit, const EditSource& source);
  /// Files that the edit reads, by a function input_files(); null for edits whose source stands for all files.
  std::vector<std::filesystem::path> (*input_files)(const void* edit);
  /// Why files that the edit reads besides its source are missing or have changed, by a function input_problem();
  /// empty: they are unchanged. Null for edits without such files.
  std::string (*input_problem)(const void* edit);
};

/// The EditType of an edit struct; specialised per edit.
template <class T>
const EditType& edit_type();

/// A change of a scene as data: an immutable, shared value of one of the edit structs. Copying is cheap.
class Edit {
 public:
  template <class T>
  requires requires { T::op; }
  Edit(T edit) : type_(&edit_type<T>()), value_(std::make_shared<const T>(std::move(edit))) {}

  const EditType& type() const { return *type_; }
  /// The struct; null if the edit is of another kind.
  template <class T>
  const T* as() const {
    return type_ == &edit_type<T>() ? static_cast<const T*>(value_.get()) : nullptr;
  }
  template <class T>
  bool is() const {
    return as<T>() != nullptr;
  }
  /// Pointer to the struct, for the functions of type().
  const void* value() const { return value_.get(); }

 private:
  const EditType* type_;
  std::shared_ptr<const void> value_;
};

/// All kinds of edits, in help order.
std::span<const EditType* const> edit_types();

/// Applies an edit: pure and deterministic. Report lines are prefixed with the edit's name. Throws Error if the edit is
/// impossible, and Cancelled.
Outcome carry_out(const Scene& scene, const Edit& edit, const Progress& progress);
/// The same as carry_out(). Accepts only Edit itself, without implicit conversion, so that calls with an edit struct
/// find that struct's own apply().
template <std::same_as<Edit> E>
Outcome apply(const Scene& scene, const E& edit, const Progress& progress = {}) {
  return carry_out(scene, edit, progress);
}

/// Parses an edit from its JSON object; node names are looked up in `scene`. Throws FieldError.
Edit read_edit(const nlohmann::json& object, const Scene& scene);

/// The edit as one JSON object, with node ids instead of names.
nlohmann::json to_json(const Edit& edit);
/// The same with the names that the nodes have in `scene`, to which the edit applies.
nlohmann::json to_json_with_names(const Edit& edit, const Scene& scene);

}  // namespace rebake
