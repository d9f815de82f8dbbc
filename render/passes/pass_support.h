#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>

#include "render/gl/to_glm.h"
#include "render/graph/passes.h"
#include "render/passes/depth_pyramid.h"

namespace rebake {

/// The cached program of two files in shaders/ with a common preamble. Throws DeviceError if it does not compile.
const gl::Program& program(PassState& state, const std::string& vertex, const std::string& fragment,
                           const std::string& preamble);

/// Preamble of the decoder function: generated GLSL with constant weights, or the defines of decoder_buffer.glsl, whose
/// buffers it uploads.
std::string decoder_preamble(const PassInput& input);
/// Binds the weight buffers, if the plan uses them, to texture units 4 and 5.
void bind_decoders(const PassInput& input, const gl::Program& program);

/// Rotation from camera space into the space of the directions that are fed to the decoder.
Mat3 camera_to_fed(const FramePlan& plan, const DecodeFrame& frame);
/// Factor and offset that decode the stored alpha in unpack.glsl.
glm::vec2 alpha_factors(AlphaCode code);

/// Sets ray_scale and ray_offset, which map sample positions to rays; `side`: samples per pixel side.
void set_ray_uniforms(const gl::Program& program, const View& view, int side);

void set_uniform(const gl::Program& program, const char* name, int value);
void set_uniform(const gl::Program& program, const char* name, float value);
void set_uniform(const gl::Program& program, const char* name, unsigned value);
void set_uniform(const gl::Program& program, const char* name, const glm::vec2& value);
void set_uniform(const gl::Program& program, const char* name, const glm::vec3& value);
void set_uniform(const gl::Program& program, const char* name, const glm::vec4& value);
void set_uniform(const gl::Program& program, const char* name, const glm::ivec2& value);
void set_uniform(const gl::Program& program, const char* name, const glm::mat3& value);
void set_uniform(const gl::Program& program, const char* name, const glm::mat4& value);

/// Light targets of a plan: 0 for none, 1 for factors, 2 for factors and offsets.
int light_level(const FramePlan& plan);
/// Defines for a draw's light map: LIT_MESH, GLOSSY_MESH, GLOSS_SUNS.
std::string light_preamble(const Draw& draw);
/// Define CODED_TEXELS: how texel.glsl reads a draw's texels.
std::string texel_preamble(const PassInput& input, const Draw& draw);

/// Whether depth is reversed: 1 at the near plane, 0 at the far plane. Without clip control it is −1 … 1.
bool reversed_depth();
/// Whether the driver computes in 16-bit floats (RenderOptions::Arithmetic::halves).
bool computes_halves();
/// Matrix from camera to clip space.
Eigen::Matrix4d projection(const View& view);
/// Factor and offset that map depth z / w in clip space to nearness: 1 at the near plane, 0 at the far plane.
Vec2 nearness_of_depth();

/// Sets the uniforms of geometry.vert for a set, and binds its texels.
void set_mesh_uniforms(const PassInput& input, const Draw& draw, const gl::Program& program);
/// Calls set_mesh_uniforms(), and binds the vertices and the light map of a set.
void bind_set(const PassInput& input, const Draw& draw, const gl::Program& program);
void unbind_set(const Draw& draw);
/// Binds a set and draws its clusters in view (frustum culling).
void draw_set(const PassInput& input, const Draw& draw, const gl::Program& program);
/// Draws all sets of a plan in order, without occlusion culling. Consecutive instances of one object share their
/// bindings. `use` binds the program for a set and returns it.
void draw_all_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use);

/// Sets the scissor rectangle to plan.covered, with `side` samples per pixel side.
void restrict_to_covered(const FramePlan& plan, int side);
/// Sets the scissor rectangle for clears: plan.covered, or the whole target if guides test against its depth or if that
/// is faster, unless pixels outside are kept. Call end_clear() afterwards.
void begin_clear(const FramePlan& plan);
void clear_depth();  ///< to the far plane
void end_clear();
/// Sets the state for drawing triangles: depth test (nearer or equal), reversed depth if possible, no back-face
/// culling, scissor to plan.covered. `side`: samples per pixel side.
void begin_geometry(const FramePlan& plan, int side);
void end_geometry();

/// Draws rectangles of pixels, y up, with a program that uses rectangles.vert.
void draw_rectangles(const View& view, const gl::Program& program, const std::vector<SampleRect>& rectangles);

/// Sets the state for drawing over the whole picture (or only plan.covered if pixels outside are kept): no depth test,
/// the depth convention of the scene.
void begin_overlay(const FramePlan& plan);
/// Binds the scene's depth to texture unit 1 and sets the uniforms scene_depth, side and nearer.
void bind_scene_depth(const PassInput& input, const gl::Program& program);
/// Clears Target::mask as far as drawn pixels depend on it, and sets the state for drawing into it: the strongest mark
/// of a pixel wins. Call end_mask() afterwards.
void begin_mask(const PassInput& input);
/// Binds the program that draws a set into the mask with a strength of 0 … 1.
const gl::Program& use_mask(const PassInput& input, const Draw& draw, float strength = 1);
void end_mask();
/// Draws over the picture with a fragment shader that reads the mask.
void draw_by_mask(const PassInput& input, const std::string& fragment);
void set_camera_to_clip(const FramePlan& plan, const gl::Program& program);
/// Creates a vertex array of a mesh's positions and a surface's vertices, without an element buffer.
gl::VertexArray make_position_array(const GpuMesh& mesh, const GpuSurface& surface);

}  // namespace rebake
