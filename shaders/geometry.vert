layout(location = 0) in vec3 position;  // object space, relative to the mesh's centre
layout(location = 1) in vec2 texel;     // in texels, v down
layout(location = 6) in uvec4 rectangle;  // first and last texel of those that the vertex's triangles show
layout(location = 7) in uvec2 place;      // of the first one on the GPU
#if TURNED_MESH
layout(location = 2) in mat3 turn;  // by which an edit turned the vertex against its object
uniform mat3 object_to_fed;     // the axes of the decoder
out vec3 turned_ray;
#endif
#if GLOSSY_MESH
out vec3 baked_ray;   // in the object's space, as the surface saw it when it was baked
out vec3 object_ray;  // and as it is
#endif
#if TURNED_MESH || GLOSSY_MESH
uniform bool parallel_rays;     // of an orthographic camera
uniform mat4 object_to_camera;
uniform mat3 camera_to_object;  // directions, orthogonal
#endif
#if LIT_MESH
layout(location = 5) in vec2 light_place;  // in nodes of the light map
uniform vec2 light_size;
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
  // Unnormalised, so that interpolation over the triangle is exact where all three turns agree.
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
