#include "render/graph/passes.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <stdexcept>

#include "render/gl/shader_library.h"

namespace rebake {

namespace {

void check_declared(const Effect& effect, std::span<const Use> uses, Target target, const char* what) {
  if (std::none_of(uses.begin(), uses.end(), [&](const Use& use) { return use.target == target; }))
    throw std::logic_error(std::string(effect.name) + " does not declare that it " + what + " this target");
}

}  // namespace

const gl::Program& ProgramCache::get(const std::string& vertex, const std::string& fragment,
                                     const std::string& preamble) {
  const std::string key = vertex + '\n' + fragment + '\n' + preamble;
  auto found = entries_.find(key);
  if (found == entries_.end()) {
    gl::Program program = gl::make_program(gl::shader_source(vertex, preamble), gl::shader_source(fragment, preamble));
    if (entries_.size() >= most)
      entries_.erase(std::min_element(entries_.begin(), entries_.end(),
                                      [](const auto& a, const auto& b) { return a.second.used < b.second.used; }));
    ++made_;
    found = entries_.emplace(key, Entry{std::move(program), 0}).first;
  }
  found->second.used = ++clock_;
  return found->second.program;
}

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
