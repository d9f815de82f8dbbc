#pragma once

// Describes an edit's fields to the framework. Included only by the edit's own .cpp.

#include "editor/edits/edit.h"
#include "editor/fields/visitors.h"

namespace rebake::described {

/// Field visitor that collects the nodes in an edit's fields.
struct NamedNodes {
  std::vector<NodeId> nodes;
  void operator()(const char*, const NodeRef& node, Need, const char*, Unit = Unit::none) { nodes.push_back(node.id); }
  void operator()(const char*, const std::optional<NodeRef>& node, Need, const char*, Unit = Unit::none) {
    if (node) nodes.push_back(node->id);
  }
  void operator()(const char*, const std::vector<NodeRef>& list, Need, const char*, Unit = Unit::none) {
    for (const NodeRef& node : list) nodes.push_back(node.id);
  }
  template <class T>
  void operator()(const char*, const T&, Need, const char*, Unit = Unit::none) {}
};

/// Builds the EditType of the edit struct T. `Describe` is a captureless lambda (edit, visit) that calls `visit(name,
/// member, need, help, unit)` for each field.
template <class T, class Describe>
EditType type_of(const char* help, Describe) {
  EditType type{};
  type.op = T::op;
  type.help = help;
  type.selects = requires { T::selects; };
  type.fields = [] {
    std::vector<FieldInfo> lines;
    FieldLister lister(lines);
    const T standard{};
    Describe{}(standard, lister);
    return lines;
  };
  type.read = [](const nlohmann::json& object, const Scene& scene) {
    T edit;
    FieldReader reader(object, scene);
    Describe{}(edit, reader);
    reader.finish();
    return Edit(std::move(edit));
  };
  type.write = [](const void* edit) {
    nlohmann::json object = {{"op", T::op}};
    FieldWriter writer(object);
    Describe{}(*static_cast<const T*>(edit), writer);
    return object;
  };
  type.apply = [](const Scene& scene, const void* edit, const Progress& progress) -> Outcome {
    const T& one = *static_cast<const T*>(edit);
    if constexpr (requires { apply(scene, one, progress); })
      return apply(scene, one, progress);
    else
      return apply(scene, one);
  };
  type.named_nodes = [](const void* edit) {
    NamedNodes named;
    Describe{}(*static_cast<const T*>(edit), named);
    return std::move(named.nodes);
  };
  return type;
}

}  // namespace rebake::described

/// Defines edit_type<Type>(). Arguments: the struct, one sentence of help, and (auto& edit, auto& visit) {…} that
/// visits the fields.
#define REBAKE_DESCRIBE_EDIT(Type, help, ...)                                    \
  template <>                                                                    \
  const EditType& edit_type<Type>() {                                            \
    static const EditType type = described::type_of<Type>(help, [] __VA_ARGS__); \
    return type;                                                                 \
  }
