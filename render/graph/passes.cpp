#include "render/graph/passes.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <stdexcept>

namespace rebake {

namespace {

void check_declared(const Effect& effect, std::span<const Use> uses, Target target, const char* what) {
  if (std::none_of(uses.begin(), uses.end(), [&](const Use& use) { return use.target == target; }))
    throw std::logic_error(std::string(effect.name) + " does not say that it " + what + " this target");
}

}  // namespace

unsigned PassInput::read(Target target) const {
  check_declared(effect, effect.reads, target, "reads");
  return state.targets.texture(target).name();
}

void PassInput::draw_to(const std::vector<Target>& colors, bool depth) const {
  for (const Target target : colors) check_declared(effect, effect.writes, target, "writes");
  if (depth) check_declared(effect, effect.writes, Target::depth, "writes");
  glBindFramebuffer(GL_FRAMEBUFFER, state.targets.framebuffer(colors, depth).name());
}

}  // namespace rebake
