#include "render/passes/pass_support.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "render/graph/changed_pixels.h"
#include "render/passes/decoder_glsl.h"
#include "render/passes/gloss_uniforms.h"

namespace rebake {

namespace {

GLint location(const gl::Program& program, const char* name) { return glGetUniformLocation(program.name(), name); }

bool outside(const Eigen::Matrix4d& object_to_clip, const Box& box) {
  // Frustum culling: whether all eight corners are beyond one of the planes x = ±w and y = ±w.
  int left = 0, right = 0, down = 0, up = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4d c = object_to_clip * box.corner(static_cast<Box::CornerType>(corner)).homogeneous();
    left += c.x() < -c.w() ? 1 : 0;
    right += c.x() > c.w() ? 1 : 0;
    down += c.y() < -c.w() ? 1 : 0;
    up += c.y() > c.w() ? 1 : 0;
  }
  return left == 8 || right == 8 || down == 8 || up == 8;
}

}  // namespace

// Reversed depth keeps float depth precise at any distance.
bool reversed_depth() {
  // Queried on each call, because threads may draw in contexts of different drivers.
  return epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
}

bool computes_halves() { return epoxy_gl_version() >= 40 && epoxy_has_gl_extension(half_extension); }

Eigen::Matrix4d projection(const View& view) {
  const double f = 1 / half_height(view.camera, 1);
  const double n = view.camera.near_plane, r = view.camera.far_plane;
  Eigen::Matrix4d p = Eigen::Matrix4d::Zero();
  p(0, 0) = f * view.height / view.width;
  p(1, 1) = f;
  if (view.camera.orthographic()) {
    p(3, 3) = 1;
    if (reversed_depth()) {
      p(2, 2) = 1 / (r - n);
      p(2, 3) = r / (r - n);
    } else {
      p(2, 2) = -2 / (r - n);
      p(2, 3) = -(r + n) / (r - n);
    }
    return p;
  }
  p(3, 2) = -1;
  if (reversed_depth()) {
    p(2, 2) = n / (r - n);
    p(2, 3) = n * r / (r - n);
  } else {
    p(2, 2) = -(r + n) / (r - n);
    p(2, 3) = -2 * n * r / (r - n);
  }
  return p;
}

Vec2 nearness_of_depth() { return reversed_depth() ? Vec2(1, 0) : Vec2(-0.5, 0.5); }

const gl::Program& program(PassState& state, const std::string& vertex, const std::string& fragment,
                           const std::string& preamble) {
  return state.programs.get(vertex, fragment, preamble);
}

std::string decoder_preamble(const PassInput& input) {
  const FramePlan& plan = input.plan;
  if (plan.options.weights == RenderOptions::Weights::constants) {
    DecoderText& made = input.state.text;
    const RenderOptions& options = plan.options;
    if (options.arithmetic == RenderOptions::Arithmetic::halves && !computes_halves())
      throw DeviceError(fmt::format("the OpenGL driver does not compute in 16-bit floats ({})", half_extension));
    if (made.text.empty() || made.decoders != plan.decoders || made.precision != options.precision ||
        made.arithmetic != options.arithmetic)
      made = {plan.decoders, options.precision, options.arithmetic,
              decoder_constants_glsl(plan.decoders, options.precision, options.arithmetic)};
    return made.text;
  }
  DecoderTables& tables = input.state.tables;
  if (!tables.weights || tables.decoders != plan.decoders || tables.precision != plan.options.precision) {
    const DecoderBuffers buffers = decoder_buffers(plan.decoders, plan.options.precision);
    tables.decoders = plan.decoders;
    tables.precision = plan.options.precision;
    tables.widest_layer = buffers.widest_layer;
    tables.weights_buffer =
        gl::make_buffer(GL_TEXTURE_BUFFER, buffers.weights.data(), buffers.weights.size() * sizeof(float));
    tables.layout_buffer =
        gl::make_buffer(GL_TEXTURE_BUFFER, buffers.layout.data(), buffers.layout.size() * sizeof(float));
    tables.weights = gl::make_buffer_texture(tables.weights_buffer, GL_RGBA32F);
    tables.layout = gl::make_buffer_texture(tables.layout_buffer, GL_RGBA32F);
  }
  return fmt::format("#define WIDEST_LAYER {}\n#define DECODER_BUFFER 1\n", tables.widest_layer);
}

void bind_decoders(const PassInput& input, const gl::Program& program) {
  if (input.plan.options.weights == RenderOptions::Weights::constants) return;
  glActiveTexture(GL_TEXTURE4);
  glBindTexture(GL_TEXTURE_BUFFER, input.state.tables.weights.name());
  glActiveTexture(GL_TEXTURE5);
  glBindTexture(GL_TEXTURE_BUFFER, input.state.tables.layout.name());
  set_uniform(program, "decoder_weights", 4);
  set_uniform(program, "decoder_layout", 5);
}

Mat3 camera_to_fed(const FramePlan& plan, const DecodeFrame& frame) {
  return frame.world_to_decoder * world_to_camera(plan.view.camera).transpose();
}

glm::vec2 alpha_factors(AlphaCode code) { return code == AlphaCode::halved ? glm::vec2(2, -1) : glm::vec2(1, 0); }

void set_ray_uniforms(const gl::Program& program, const View& view, int side) {
  // All rays of an orthographic camera are (0, 0, −1).
  const double top = view.camera.orthographic() ? 0 : half_height(view.camera, 1);
  const double right = top * view.width / view.height;
  set_uniform(program, "ray_scale", glm::vec2(2 * right / (view.width * side), 2 * top / (view.height * side)));
  set_uniform(program, "ray_offset", glm::vec2(-right, -top));
}

void set_uniform(const gl::Program& program, const char* name, int value) {
  glUniform1i(location(program, name), value);
}
void set_uniform(const gl::Program& program, const char* name, float value) {
  glUniform1f(location(program, name), value);
}
void set_uniform(const gl::Program& program, const char* name, unsigned value) {
  glUniform1ui(location(program, name), value);
}
void set_uniform(const gl::Program& program, const char* name, const glm::vec2& value) {
  glUniform2fv(location(program, name), 1, glm::value_ptr(value));
}
void set_uniform(const gl::Program& program, const char* name, const glm::vec3& value) {
  glUniform3fv(location(program, name), 1, glm::value_ptr(value));
}
void set_uniform(const gl::Program& program, const char* name, const glm::vec4& value) {
  glUniform4fv(location(program, name), 1, glm::value_ptr(value));
}
void set_uniform(const gl::Program& program, const char* name, const glm::ivec2& value) {
  glUniform2iv(location(program, name), 1, glm::value_ptr(value));
}
void set_uniform(const gl::Program& program, const char* name, const glm::mat3& value) {
  glUniformMatrix3fv(location(program, name), 1, GL_FALSE, glm::value_ptr(value));
}
void set_uniform(const gl::Program& program, const char* name, const glm::mat4& value) {
  glUniformMatrix4fv(location(program, name), 1, GL_FALSE, glm::value_ptr(value));
}

int light_level(const FramePlan& plan) {
  return plan.runs(effects::light_offset) ? 2 : plan.runs(effects::light) ? 1 : 0;
}

std::string texel_preamble(const PassInput& input, const Draw& draw) {
  return fmt::format("#define CODED_TEXELS {}\n", input.gpu.surface(draw.set).coded ? 1 : 0);
}

std::string light_preamble(const Draw& draw) {
  return fmt::format("#define LIT_MESH {}\n#define GLOSSY_MESH {}\n#define GLOSS_SUNS {}\n",
                     !draw.light                  ? 0
                     : draw.light->offset.empty() ? 1
                                                  : 2,
                     draw.light && draw.light->gloss ? 1 : 0, Gloss::max_suns);
}

namespace {

void bind_texels(const GpuSurface& surface, const gl::Program& program) {
  glActiveTexture(GL_TEXTURE0);
  if (!surface.coded) {
    glBindTexture(GL_TEXTURE_2D, surface.texels.name());
    set_uniform(program, "features", 0);
    return;
  }
  glBindTexture(GL_TEXTURE_BUFFER, surface.coded->read_blocks.name());
  set_uniform(program, "texel_blocks", 0);
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_BUFFER, surface.coded->read_words.name());
  set_uniform(program, "texel_words", 2);
}

}  // namespace

void set_mesh_uniforms(const PassInput& input, const Draw& draw, const gl::Program& program) {
  const GpuMesh& mesh = input.gpu.mesh(draw.set);
  Affine to_camera = draw.to_camera;
  to_camera.translation() += draw.to_camera.linear() * mesh.center;
  const Eigen::Matrix4d to_clip = projection(input.plan.view);
  set_uniform(program, "object_to_clip", to_glm(Eigen::Matrix4d(to_clip * to_camera.matrix())));
  const bool turned = draw.set.soup.rotations() != nullptr;
  if (turned || (draw.light && draw.light->gloss)) {
    const Mat3 axes = axes_matrix(draw.axes);
    set_uniform(program, "parallel_rays", input.plan.view.camera.orthographic() ? 1 : 0);
    set_uniform(program, "object_to_camera", to_glm(Eigen::Matrix4d(to_camera.matrix())));
    set_uniform(program, "camera_to_object",
                to_glm(Mat3(axes.transpose() * camera_to_fed(input.plan, input.plan.frames[draw.frame]))));
    if (turned) set_uniform(program, "object_to_fed", to_glm(axes));
  }
  bind_texels(input.gpu.surface(draw.set), program);
}

namespace {

void bind_gloss(const GpuLight& light, const Gloss& gloss, const gl::Program& program) {
  const gl::Texture* const textures[] = {&light.gloss_before, &light.gloss_after, &light.gloss_suns};
  const char* const names[] = {"gloss_before", "gloss_after", "gloss_suns"};
  for (int k = 0; k < 3; ++k) {
    glActiveTexture(GL_TEXTURE8 + static_cast<GLenum>(k));
    glBindTexture(GL_TEXTURE_2D, textures[k]->name());
    set_uniform(program, names[k], 8 + k);
  }
  const GlossUniforms values = gloss_uniforms(gloss);
  glUniform3fv(location(program, "gloss_sky"), sh::count, values.sky[0].data());
  glUniform3fv(location(program, "gloss_sun_direction"), Gloss::max_suns, values.directions[0].data());
  glUniform3fv(location(program, "gloss_sun_light"), Gloss::max_suns, values.lights[0].data());
  set_uniform(program, "gloss_sun_count", values.suns);
  set_uniform(program, "gloss_sharpness", values.sharpness);
}

}  // namespace

void bind_set(const PassInput& input, const Draw& draw, const gl::Program& program) {
  set_mesh_uniforms(input, draw, program);
  const GpuMesh& mesh = input.gpu.mesh(draw.set);
  glBindVertexArray(mesh.array.name());
  if (draw.light) {
    const GpuLight& light = input.gpu.light(draw.light);
    glBindBuffer(GL_ARRAY_BUFFER, light.places.name());
    glEnableVertexAttribArray(5);
    glVertexAttribPointer(5, 2, GL_FLOAT, GL_FALSE, 2 * sizeof(float), nullptr);
    set_uniform(program, "light_size", glm::vec2(draw.light->chart->width, draw.light->chart->height));
    glActiveTexture(GL_TEXTURE6);
    glBindTexture(GL_TEXTURE_2D, light.gain.name());
    set_uniform(program, "light_gain", 6);
    glActiveTexture(GL_TEXTURE7);
    glBindTexture(GL_TEXTURE_2D, light.offset.name());
    set_uniform(program, "light_offset", 7);
    if (draw.light->gloss) bind_gloss(light, *draw.light->gloss->gloss, program);
  }
}

void unbind_set(const Draw& draw) {
  if (draw.light) glDisableVertexAttribArray(5);
}

namespace {

// Camera to clip space for frustum culling. If pixels outside plan.covered are kept, the frustum is narrowed to
// plan.covered with the margin of marks.
Eigen::Matrix4d drawn_projection(const FramePlan& plan) {
  Eigen::Matrix4d part = Eigen::Matrix4d::Identity();
  if (plan.kept) {
    const PixelRect c = around(plan.covered, mask_radius, plan.view);
    const double width = plan.view.width, height = plan.view.height;
    part(0, 0) = width / (c.right - c.left);
    part(1, 1) = height / (c.bottom - c.top);
    part(0, 3) = (width - c.right - c.left) / (c.right - c.left);
    part(1, 3) = (c.bottom + c.top - height) / (c.bottom - c.top);
  }
  return part * projection(plan.view);
}

// Draws the clusters in view of a bound set.
void draw_clusters(const GpuMesh& mesh, const Eigen::Matrix4d& object_to_clip) {
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;
  for (const GpuCluster& cluster : mesh.clusters) {
    if (outside(object_to_clip, cluster.bounds)) continue;
    const auto begin = reinterpret_cast<const void*>(cluster.first_face * sizeof(Face));
    const auto count = static_cast<GLsizei>(cluster.face_count * 3);
    // Merges consecutive clusters in view into one range: each range costs a draw call in the driver.
    if (!counts.empty() &&
        reinterpret_cast<std::size_t>(offsets.back()) + static_cast<std::size_t>(counts.back()) * 4 ==
            reinterpret_cast<std::size_t>(begin)) {
      counts.back() += count;
      continue;
    }
    counts.push_back(count);
    offsets.push_back(begin);
  }
  if (counts.size() == 1)
    glDrawElements(GL_TRIANGLES, counts.front(), GL_UNSIGNED_INT, offsets.front());
  else if (!counts.empty())
    glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(),
                        static_cast<GLsizei>(counts.size()));
}

// Whether two draws share all bindings and differ only in their transform.
bool same_bindings(const Draw& a, const Draw& b) {
  const Soup &first = a.set.soup, &second = b.set.soup;
  return a.frame == b.frame && !a.light && !b.light && first.rotations() == nullptr && second.rotations() == nullptr &&
         first.shared_positions() == second.shared_positions() && first.shared_uvs() == second.shared_uvs() &&
         first.shared_faces() == second.shared_faces() && a.set.texels == b.set.texels;
}

}  // namespace

void draw_set(const PassInput& input, const Draw& draw, const gl::Program& program) {
  bind_set(input, draw, program);
  draw_clusters(input.gpu.mesh(draw.set), drawn_projection(input.plan) * draw.to_camera.matrix());
  unbind_set(draw);
}

void draw_all_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use) {
  const Eigen::Matrix4d to_clip = projection(input.plan.view), to_drawn = drawn_projection(input.plan);
  const Draw* bound = nullptr;
  const GpuMesh* mesh = nullptr;
  GLint place = -1;
  for (const Draw& draw : input.plan.draws) {
    if (bound != nullptr && same_bindings(*bound, draw)) {
      Eigen::Matrix4d to_camera = draw.to_camera.matrix();
      to_camera.topRightCorner<3, 1>() += draw.to_camera.linear() * mesh->center;
      glUniformMatrix4fv(place, 1, GL_FALSE, glm::value_ptr(to_glm(Eigen::Matrix4d(to_clip * to_camera))));
    } else {
      if (bound != nullptr) unbind_set(*bound);
      const gl::Program& program = use(draw);
      bind_set(input, draw, program);
      bound = &draw;
      mesh = &input.gpu.mesh(draw.set);
      place = location(program, "object_to_clip");
    }
    draw_clusters(*mesh, to_drawn * draw.to_camera.matrix());
  }
  if (bound != nullptr) unbind_set(*bound);
}

namespace {

void restrict_to(const PixelRect& rect, const View& view, int side) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.left * side, (view.height - rect.bottom) * side, (rect.right - rect.left) * side,
            (rect.bottom - rect.top) * side);
}

}  // namespace

void restrict_to_covered(const FramePlan& plan, int side) { restrict_to(plan.covered, plan.view, side); }

void begin_geometry(const FramePlan& plan, int side) {
  glViewport(0, 0, plan.view.width * side, plan.view.height * side);
  restrict_to_covered(plan, side);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  if (reversed_depth()) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDepthFunc(reversed_depth() ? GL_GEQUAL : GL_LEQUAL);
}

void begin_clear(const FramePlan& plan) {
  // Drivers have a fast clear for whole targets. They clear a part by drawing, 2 to 3 times slower per sample.
  const auto area = [](double width, double height) { return width * height; };
  const PixelRect& c = plan.covered;
  const bool most = 3 * area(c.right - c.left, c.bottom - c.top) > area(plan.view.width, plan.view.height);
  if (!plan.kept && (most || plan.runs(effects::guides))) glDisable(GL_SCISSOR_TEST);
}

void clear_depth() {
  const float farthest = reversed_depth() ? 0.0F : 1.0F;
  glClearBufferfv(GL_DEPTH, 0, &farthest);
}

void end_clear() { glEnable(GL_SCISSOR_TEST); }

void draw_rectangles(const View& view, const gl::Program& program, const std::vector<SampleRect>& rectangles) {
  std::vector<glm::vec2> corners;
  for (const SampleRect& r : rectangles)
    for (const auto& [x, y] : {std::pair(r.left, r.bottom),
                               {r.right, r.bottom},
                               {r.right, r.top},
                               {r.left, r.bottom},
                               {r.right, r.top},
                               {r.left, r.top}})
      corners.emplace_back(x, y);
  if (corners.empty()) return;
  const gl::VertexArray array = gl::make_vertex_array();
  glBindVertexArray(array.name());
  const gl::Buffer buffer = gl::make_buffer(GL_ARRAY_BUFFER, corners.data(), corners.size() * sizeof(corners[0]));
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  set_uniform(program, "picture_size", glm::vec2(view.width, view.height));
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
  glBindVertexArray(0);
}

void begin_overlay(const FramePlan& plan) {
  glViewport(0, 0, plan.view.width, plan.view.height);
  glDisable(GL_SCISSOR_TEST);
  if (plan.kept) restrict_to_covered(plan, 1);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  if (reversed_depth()) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

void bind_scene_depth(const PassInput& input, const gl::Program& program) {
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, input.read(Target::depth));
  set_uniform(program, "scene_depth", 1);
  set_uniform(program, "side", input.plan.view.side());
  set_uniform(program, "nearer", reversed_depth() ? 1.0F : -1.0F);
}

void set_camera_to_clip(const FramePlan& plan, const gl::Program& program) {
  set_uniform(program, "camera_to_clip", to_glm(projection(plan.view)));
}

gl::VertexArray make_position_array(const GpuMesh& mesh, const GpuSurface& surface) {
  gl::VertexArray array = gl::make_vertex_array();
  glBindVertexArray(array.name());
  bind_vertices(mesh.positions, surface);
  glBindVertexArray(0);
  return array;
}

void end_geometry() {
  glBindVertexArray(0);
  glDisable(GL_DEPTH_TEST);
  if (reversed_depth()) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

void begin_mask(const PassInput& input) {
  input.draw_to({Target::mask}, false);
  begin_overlay(input.plan);
  // Passes share the mask, so the margin around plan.covered holds marks of another pass.
  if (input.plan.kept) restrict_to(around(input.plan.covered, mask_radius, input.plan.view), input.plan.view, 1);
  const float nothing[4] = {};
  glClearBufferfv(GL_COLOR, 0, nothing);
  glEnable(GL_BLEND);
  glBlendEquation(GL_MAX);
}

const gl::Program& use_mask(const PassInput& input, const Draw& draw, float strength) {
  const gl::Program& mask =
      program(input.state, "geometry.vert", "selection_mask.frag",
              "#define TURNED_MESH 0\n#define LIT_MESH 0\n#define GLOSSY_MESH 0\n" + texel_preamble(input, draw));
  glUseProgram(mask.name());
  bind_scene_depth(input, mask);
  set_uniform(mask, "strength", strength);
  return mask;
}

void end_mask() {
  glBlendEquation(GL_FUNC_ADD);
  end_geometry();
}

void draw_by_mask(const PassInput& input, const std::string& fragment) {
  input.draw_to({Target::picture}, false);
  if (input.plan.kept) restrict_to_covered(input.plan, 1);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const gl::Program& shader = program(input.state, "fullscreen.vert", fragment, "");
  glUseProgram(shader.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, input.read(Target::mask));
  set_uniform(shader, "mask", 0);
  glBindVertexArray(input.state.empty_array.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

}  // namespace rebake
