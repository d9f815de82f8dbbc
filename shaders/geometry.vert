layout(location = 0) in vec3 position;    // object space, relative to the mesh's centre
layout(location = 1) in vec2 texel;       // texture coordinates in texels, v down
layout(location = 6) in uvec4 rectangle;  // corners of its rectangle of texels, inclusive
layout(location = 7) in uvec2 place;      // SurfaceVertex::place in render/gpu_scene
#if TURNED_MESH
layout(location = 2) in mat3 turn;  // rotation of the vertex by edits, relative to its object
uniform mat3 object_to_fed;         // axes of the decoder
out vec3 turned_ray;
#endif
#if GLOSSY_MESH
out vec3 baked_ray;   // view ray in object space, rotated back to the surface as baked
out vec3 object_ray;  // view ray in object space
#endif
#if TURNED_MESH || GLOSSY_MESH
uniform bool parallel_rays;     // whether the camera is orthographic
uniform mat4 object_to_camera;
uniform mat3 camera_to_object;  // rotation of directions
#endif
#if LIT_MESH
layout(location = 5) in vec2 light_place;  // position in the light map, in nodes
uniform vec2 light_size;                   // width and height of the light map, in nodes
out vec2 at_light;
#endif
uniform mat4 object_to_clip;
out vec2 at_texel;
flat out uvec3 packed_at;

void main() {
  gl_Position = object_to_clip * vec4(position, 1.0);
  at_texel = texel;
  packed_at = uvec3(rectangle.xz | rectangle.yw << 16, place.x | place.y << 16);
#if LIT_MESH
  at_light = light_place / light_size;
#endif
#if TURNED_MESH || GLOSSY_MESH
  // Not normalised: interpolation over a triangle is then exact if its three rotations agree.
  vec3 ray = camera_to_object * (parallel_rays ? vec3(0.0, 0.0, -1.0) : (object_to_camera * vec4(position, 1.0)).xyz);
#endif
#if TURNED_MESH
  turned_ray = object_to_fed * (ray * turn);
#endif
#if GLOSSY_MESH
  object_ray = ray;
#if TURNED_MESH
  baked_ray = ray * turn;
#else
  baked_ray = ray;
#endif
#endif
}
