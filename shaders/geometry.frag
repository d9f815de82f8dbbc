#include "texel.glsl"
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
#if WRITES_LIGHT
layout(location = GAIN_TARGET) out vec4 sample_gain;
#endif
#if WRITES_LIGHT > 1
layout(location = OFFSET_TARGET) out vec4 sample_offset;
#endif
#if LIT_MESH
uniform sampler2D light_gain;
uniform sampler2D light_offset;
in vec2 at_light;
#endif
#if GLOSSY_MESH
#include "gloss.glsl"
#endif

void main() {
  uvec2 texel = texel_here();
  if ((texel.r & 255u) == 0u) discard;
  sample_features = texel;
#if WRITES_FRAME
  sample_frame = frame;
#endif
#if WRITES_LIGHT
#if LIT_MESH
  sample_gain = texture(light_gain, at_light);
#else
  sample_gain = vec4(1.0);
#endif
#endif
#if WRITES_LIGHT > 1
#if LIT_MESH > 1
  sample_offset = texture(light_offset, at_light);
#else
  sample_offset = vec4(0.0);
#endif
#if GLOSSY_MESH
  sample_offset.rgb += gloss_change(at_light, sample_gain.rgb);
#endif
#endif
#if WRITES_RAY
#if TURNED_MESH
  sample_ray = vec4(normalize(turned_ray), 0.0);
#else
  sample_ray = vec4(0.0);
#endif
#endif
}
