#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>

#include "render/graph/passes.h"
#include "render/passes/depth_pyramid.h"

namespace rebake {

/// The program made of two shader files behind a preamble; compiled once.
const gl::Program& program(PassState& state, const std::string& vertex, const std::string& fragment,
                           const std::string& preamble);

/// Text of the decoder function as the plan wants it: generated constants or the buffer version.
std::string decoder_preamble(const PassInput& input);
/// Binds the weight buffers, where the plan uses them, to texture units 4 and 5.
void bind_decoders(const PassInput& input, const gl::Program& program);

glm::mat3 to_glm(const Mat3& matrix);
Mat3 camera_to_fed(const FramePlan& plan, const NodeFrame& frame);
/// Stored alpha's factor and offset, as unpack.glsl wants them.
glm::vec2 alpha_factors(AlphaCode code);

/// Sets ray_scale and ray_offset for samples of a pixel's `side`.
void set_ray_uniforms(const gl::Program& program, const View& view, int side);

void set_uniform(const gl::Program& program, const char* name, int value);
void set_uniform(const gl::Program& program, const char* name, float value);
void set_uniform(const gl::Program& program, const char* name, unsigned value);
void set_uniform(const gl::Program& program, const char* name, const glm::vec2& value);
void set_uniform(const gl::Program& program, const char* name, const glm::vec3& value);
void set_uniform(const gl::Program& program, const char* name, const glm::ivec2& value);
void set_uniform(const gl::Program& program, const char* name, const glm::mat3& value);
void set_uniform(const gl::Program& program, const char* name, const glm::mat4& value);

/// 0: no light changes; 1: by factors; 2: something is added too.
int light_level(const FramePlan& plan);
/// What shaders need to know of a draw's light map.
std::string light_preamble(const Draw& draw);
/// How texel.glsl reads a draw's texels.
std::string texel_preamble(const PassInput& input, const Draw& draw);

/// Whether depth is 1 at the near plane and 0 at the far one; without clip control it runs −1 … 1.
bool reversed_depth();
/// Camera to clip space.
Eigen::Matrix4d projection(const View& view);
/// Factor and offset that make of depth in clip space 1 at the near plane and 0 at the far one.
Vec2 nearness_of_depth();

/// Sets what geometry.vert needs of a set and binds its texture.
void set_mesh_uniforms(const PassInput& input, const Draw& draw, const gl::Program& program);
/// The same, and binds its vertices and light.
void bind_set(const PassInput& input, const Draw& draw, const gl::Program& program);
void unbind_set(const Draw& draw);
/// The same, and draws the clusters in view.
void draw_set(const PassInput& input, const Draw& draw, const gl::Program& program);
/// The plan's sets in their order; what neighbours that show one object have in common is bound once. `use` makes ready
/// to draw a set and returns the program.
void draw_all_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use);

/// From here on nothing is drawn outside plan.covered, at `side` samples.
void restrict_to_covered(const FramePlan& plan, int side);
/// What is cleared next is cleared where plan.covered is at least; all of it where lines are compared with its depth,
/// or where that is done sooner, but where the rest is kept. end_clear() after that.
void begin_clear(const FramePlan& plan);
void clear_depth();
void end_clear();
/// Depth test (less or equal, in reversed depth where the driver can), both sides drawn, restricted to plan.covered at
/// `side` samples.
void begin_geometry(const FramePlan& plan, int side);
void end_geometry();

/// Draws rectangles of the picture with rectangles.vert.
void draw_rectangles(const View& view, const gl::Program& program, const std::vector<SampleRect>& rectangles);

/// For what is drawn over the picture: its whole raster, or where the rest is kept plan.covered; the depth convention
/// of the scene, no depth test.
void begin_overlay(const FramePlan& plan);
/// Binds the scene's depth to texture unit 1, and sets scene_depth, side and nearer.
void bind_scene_depth(const PassInput& input, const gl::Program& program);
/// Clears Target::mask, as far as what is drawn depends on it, and makes ready to draw geometry into it, nearest marks
/// staying; end_mask() after that.
void begin_mask(const PassInput& input);
const gl::Program& use_mask(const PassInput& input, const Draw& draw, float strength = 1);
void end_mask();
/// Draws a fragment shader that reads the mask over the picture.
void draw_by_mask(const PassInput& input, const std::string& fragment);
void set_camera_to_clip(const FramePlan& plan, const gl::Program& program);
/// A vertex array over a mesh's vertices, without indices.
gl::VertexArray make_position_array(const GpuMesh& mesh, const GpuSurface& surface);

}  // namespace rebake
