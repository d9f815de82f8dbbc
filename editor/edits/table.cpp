#include "editor/edits/table.h"

#include "editor/fields/variants.h"

namespace rebake {

Edit read_edit(const nlohmann::json& object, const Scene& scene) {
  if (!object.is_object() || !object.contains("op") || !object.at("op").is_string())
    throw FieldError("op", "must name an edit");
  std::vector<std::string> known;
  if (auto edit = read_as<Edit>(object.at("op").get<std::string>(), object, scene, known)) return std::move(*edit);
  throw FieldError("op", "\"" + object.at("op").get<std::string>() + "\" is no edit");
}

Scene apply(const Scene& scene, const Edit& edit, const Progress& progress) {
  return std::visit(
      [&]<class T>(const T& one) {
        // By its exact type: any edit would do as an Edit too.
        if constexpr (requires { static_cast<Scene (*)(const Scene&, const T&, const Progress&)>(apply); })
          return apply(scene, one, progress);
        else
          return apply(scene, one);
      },
      edit);
}

nlohmann::json to_json(const Edit& edit) {
  return std::visit(
      [](const auto& one) {
        nlohmann::json object = {{"op", one.op}};
        FieldWriter writer(object);
        one.fields(one, writer);
        return object;
      },
      edit);
}

}  // namespace rebake
