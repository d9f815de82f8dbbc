#include "unpack.glsl"
#if DECODER_BUFFER
#include "decoder_buffer.glsl"
#endif
#include "texel.glsl"
uniform mat3 camera_to_fed;
uniform vec2 alpha_code;
uniform vec2 ray_scale;
uniform vec2 ray_offset;
uniform int decoder;
#if TURNED_MESH
in vec3 turned_ray;
#endif
#if LIT_MESH
#include "relight.glsl"
uniform sampler2D light_gain;
uniform sampler2D light_offset;
in vec2 at_light;
#endif
#if GLOSSY_MESH
#include "gloss.glsl"
#endif
layout(location = 0) out vec4 picture;

void main() {
  uvec2 texel = texel_here();
  if ((texel.r & 255u) == 0u) discard;
  Sums sums = Sums(uvec4(0u), 0u);
  add(sums, texel);
  vec4 low, high;
  average(sums, 1.0, alpha_code, low, high);
#if TURNED_MESH
  vec3 ray = normalize(turned_ray);
#else
  vec3 ray = camera_to_fed * normalize(vec3(gl_FragCoord.xy * ray_scale + ray_offset, -1.0));
#endif
  vec3 color = decode(decoder, low, high, ray);
#if LIT_MESH
  vec3 gain = texture(light_gain, at_light).rgb, offset = vec3(0.0);
#if LIT_MESH > 1
  offset += texture(light_offset, at_light).rgb;
#endif
#if GLOSSY_MESH
  offset += gloss_change(at_light, gain);
#endif
  color = relit(color, gain, offset);
#endif
  picture = vec4(color, 1.0);
}
