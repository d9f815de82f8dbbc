// Debug views of triangles. INSPECT: 1 wireframe, 2 opacity, 3 texture sets, 4 a feature channel, 5 overdraw.
#include "texel.glsl"
uniform int channel;     // feature byte, 0 … 7
uniform vec3 set_color;
out vec4 color;

void main() {
  uvec2 texel = texel_here();
  bool opaque = (texel.r & 255u) != 0u;
#if INSPECT == 1
  color = vec4(set_color * 0.6, 1.0);
#elif INSPECT == 2
  color = vec4(opaque ? vec3(0.7) : vec3(0.35, 0.1, 0.1), 1.0);
#else
  if (!opaque) discard;
#if INSPECT == 3
  color = vec4(set_color, 1.0);
#elif INSPECT == 4
  uint word = channel < 4 ? texel.r : texel.g;
  color = vec4(vec3(float((word >> (8 * (channel % 4))) & 255u) / 255.0), 1.0);
#else
  color = vec4(0.09, 0.045, 0.015, 1.0);
#endif
#endif
}
