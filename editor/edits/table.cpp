#include "editor/edits/table.h"

namespace rebake {

Scene apply(const Scene& scene, const Edit& edit) {
  return std::visit([&](const auto& one) { return apply(scene, one); }, edit);
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
