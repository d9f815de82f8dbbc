#include <epoxy/gl.h>

#include "mesh_ops/base/counted.h"
#include "render/passes/pass_support.h"

namespace rebake {

namespace {

// Depth tolerance between a triangle and the surface on which it lies, as a share of its distance.
constexpr double nearer = 2e-3;

void execute(const PassInput& input) {
  struct Vertex {
    glm::vec3 position;
    glm::vec4 color;
    float hidden;
  };
  const Camera& camera = input.plan.view.camera;
  const Mat3 rows = world_to_camera(camera);
  std::vector<Vertex> vertices;
  if (input.plan.guides.triangles) {
    // Moves triangles slightly towards the eye along view rays, so that they cover the same pixels.
    const glm::vec3 color = to_glm(input.plan.guides.triangle_color);
    for (const Guides::Triangle& triangle : *input.plan.guides.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 at = rows * (triangle.corners[k] - camera.eye);
        if (camera.orthographic())
          at.z() *= 1 - nearer;
        else
          at *= 1 - nearer;
        vertices.push_back({to_glm(at), glm::vec4(color, triangle.opacity[k]), -1});
      }
  }
  const auto in_triangles = static_cast<GLsizei>(vertices.size());
  for (const Guides::Line& line : input.plan.guides.lines)
    for (const Vec3* end : {&line.from, &line.to}) {
      vertices.push_back({to_glm(Vec3(rows * (*end - camera.eye))), glm::vec4(to_glm(line.color), line.opacity),
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
  set_uniform(shader, "thickness", static_cast<float>(2 * nearer));
  glDrawArrays(GL_TRIANGLES, 0, in_triangles);
  glDrawArrays(GL_LINES, in_triangles, static_cast<GLsizei>(vertices.size()) - in_triangles);
  glDisable(GL_BLEND);
  end_geometry();
}

std::optional<Decision> decide(const FrameFacts& facts) {
  const Guides& guides = facts.plan.guides;
  const std::size_t lines = guides.lines.size(), triangles = guides.triangles ? guides.triangles->size() : 0;
  if (lines + triangles == 0) return Decision{false, "no grid, cage or handle is shown"};
  return Decision{true, counted(lines, "line") + (triangles > 0 ? ", " + counted(triangles, "triangle") : "")};
}

constexpr Use reads[] = {{Target::depth}};
constexpr Use writes[] = {{Target::picture}};

}  // namespace

const Effect effects::guides{"guides", Effect::Kind::overlay, decide, execute, reads, writes};

}  // namespace rebake
