#pragma once

// Describes an edit's fields to the framework. Included only by the edit's own .cpp.

#include "editor/edits/edit.h"
#include "editor/fields/described.h"

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

/// Builds the EditType of the edit struct T.
template <class T, class Describe>
EditType type_of(const char* help, Describe) {
  EditType type{};
  type.op = T::op;
  type.help = help;
  if constexpr (requires { T::selects; }) type.selects = T::selects;
  if constexpr (requires { T::needs_selection; }) type.needs_selection = T::needs_selection;
  if constexpr (requires { T::makes_nodes; }) type.makes_nodes = T::makes_nodes;
  if constexpr (requires { T::deforms; }) type.deforms = T::deforms;
  if constexpr (requires { T::adjustable; }) type.adjustable = T::adjustable;
  type.done = [](const void* edit) -> std::string {
    if constexpr (requires(const T& one) { done_words(one); })
      return done_words(*static_cast<const T*>(edit));
    else if constexpr (requires { T::done; })
      return T::done;
    else
      return words_of(T::op) + ":";
  };
  type.title = [](const void* edit) -> std::string {
    if constexpr (requires(const T& one) { whole_title(one); })
      return whole_title(*static_cast<const T*>(edit));
    else
      return "";
  };
  type.change_title = [](const void* edit, const SceneChange& change, const void* replaced) -> std::string {
    if constexpr (requires(const T& one) { change_title(one, change, &one); })
      return change_title(*static_cast<const T*>(edit), change, static_cast<const T*>(replaced));
    else
      return "";
  };
  type.fields = fields_of<T, Describe>;
  type.read = [](const nlohmann::json& object, const Scene& scene) {
    return Edit(read_fields<T, Describe>(object, scene));
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
  if constexpr (requires { T::source_field; }) {
    type.source_field = T::source_field;
    if constexpr (requires(const T& one) { one.input_files(); })
      type.input_files = [](const void* edit) { return static_cast<const T*>(edit)->input_files(); };
    if constexpr (requires(const T& one) { one.input_problem(); })
      type.input_problem = [](const void* edit) { return static_cast<const T*>(edit)->input_problem(); };
    type.source = [](const void* edit) { return static_cast<const T*>(edit)->input(); };
    type.with_source = [](const void* edit, const EditSource& source) {
      T changed = *static_cast<const T*>(edit);
      changed.set_input(source);
      return Edit(std::move(changed));
    };
  }
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
