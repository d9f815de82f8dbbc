#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "editor/fields/fields.h"

namespace rebake {

/// Calls `visit` with a default-constructed value of each type of a variant.
template <class Variant, class Visit>
void for_each_type(Visit visit) {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (visit(std::variant_alternative_t<I, Variant>{}), ...); }
  (std::make_index_sequence<std::variant_size_v<Variant>>{});
}

/// The command of a variant whose `op` it is, read from its fields; nothing when no type has that op. Adds all ops to
/// `known`.
template <class Variant>
std::optional<Variant> read_as(const std::string& op, const nlohmann::json& line, const Scene& scene,
                               std::vector<std::string>& known) {
  std::optional<Variant> result;
  for_each_type<Variant>([&](auto command) {
    known.emplace_back(command.op);
    if (op != command.op) return;
    FieldReader reader(line, scene);
    decltype(command)::fields(command, reader);
    reader.finish();
    result = std::move(command);
  });
  return result;
}

}  // namespace rebake
