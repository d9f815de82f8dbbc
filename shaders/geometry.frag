uniform usampler2D features;
uniform ivec2 last_texel;
in vec2 at_texel;
layout(location = 0) out uvec2 sample_features;
#if WRITES_FRAME
uniform uint frame;
layout(location = FRAME_TARGET) out uint sample_frame;
#endif
#if WRITES_RAY
layout(location = RAY_TARGET) out vec4 sample_ray;
#endif
#if TURNED_MESH
in vec3 turned_ray;
#endif

void main() {
  uvec2 texel = texelFetch(features, clamp(ivec2(floor(at_texel)), ivec2(0), last_texel), 0).rg;
  if ((texel.r & 255u) == 0u) discard;
  sample_features = texel;
#if WRITES_FRAME
  sample_frame = frame;
#endif
#if WRITES_RAY
#if TURNED_MESH
  sample_ray = vec4(normalize(turned_ray), 0.0);
#else
  sample_ray = vec4(0.0);
#endif
#endif
}
