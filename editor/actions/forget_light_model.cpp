#include "editor/actions/forget_light_model.h"

#include <fmt/format.h>

#include "editor/actions/describe_action.h"
#include "editor/actions/light_model.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void run(Session& session, const ForgetLightModelAction& action) {
  const Scene& scene = session.scene();
  const NodePtr node = action.node ? find(scene, action.node->id) : object_for_light_model(scene, "");
  if (!node || !node->object) throw FieldError("node", "has no object");
  session.say(forget_light_model(scene, node, session.progress)
                  ? fmt::format("drags of \"{}\" rotate the transfer again", node->name)
                  : fmt::format("\"{}\" has no trained model", node->name));
}

REBAKE_DESCRIBE_ACTION(
    ForgetLightModelAction, "Makes drags of an object use rotated light transfer again instead of a trained model.",
    (auto& action, auto& visit) { visit("node", action.node, Need::optional, "the object; default: the only one"); })

}  // namespace rebake
