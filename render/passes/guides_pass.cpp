#include <epoxy/gl.h>

#include "render/passes/pass_support.h"

namespace rebake {

namespace {

void execute(const PassInput& input) {
  struct Vertex {
    float position[3], color[4], hidden;
  };
  const Camera& camera = input.plan.view.camera;
  const Mat3 rows = world_to_camera(camera);
  std::vector<Vertex> vertices;
  for (const Guides::Line& line : input.plan.guides.lines)
    for (const Vec3* end : {&line.from, &line.to}) {
      const Eigen::Vector3f p = (rows * (*end - camera.eye)).cast<float>();
      const Eigen::Vector3f c = line.color.cast<float>();
      vertices.push_back({{p.x(), p.y(), p.z()},
                          {c.x(), c.y(), c.z(), static_cast<float>(line.opacity)},
                          static_cast<float>(line.hidden_opacity)});
    }
  input.draw_to({Target::picture}, false);
  begin_overlay(input.plan);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const gl::VertexArray array = gl::make_vertex_array();
  glBindVertexArray(array.name());
  const gl::Buffer buffer = gl::make_buffer(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * sizeof(Vertex));
  const auto attribute = [](GLuint index, int count, std::size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, count, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 4, offsetof(Vertex, color));
  attribute(2, 1, offsetof(Vertex, hidden));
  const gl::Program& shader = program(input.state, "guides.vert", "guides.frag", "");
  glUseProgram(shader.name());
  bind_scene_depth(input, shader);
  set_uniform(shader, "empty", input.plan.draws.empty() ? 1 : 0);
  set_camera_to_clip(input.plan, shader);
  glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(vertices.size()));
  glDisable(GL_BLEND);
  end_geometry();
}

std::optional<Decision> decide(const FrameFacts& facts) {
  const std::size_t lines = facts.plan.guides.lines.size();
  if (lines == 0) return Decision{false, "no grid, cage or handle is shown"};
  return Decision{true, plural(lines, "line", "lines")};
}

constexpr Use reads[] = {{Target::depth}};
constexpr Use writes[] = {{Target::picture}};

}  // namespace

const Effect effects::guides{"guides", Effect::Kind::overlay, decide, execute, reads, writes};

}  // namespace rebake
