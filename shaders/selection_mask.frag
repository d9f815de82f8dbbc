// Selected triangles into a mask: `strength` where they are visible, less where they are occluded.
#include "texel.glsl"
uniform sampler2D scene_depth;
uniform int side;       // samples along a pixel's side
uniform float nearer;   // 1 where larger depths are nearer, else -1
uniform float strength;  // 0 … 1; below 1 for selections that the next command leaves alone
layout(location = 0) out float mask;

void main() {
  // Outside any branch: derivatives need all four pixels.
  float slack = 2.0 * fwidth(gl_FragCoord.z);
  uvec2 texel = texel_here();
  if ((texel.r & 255u) == 0u) discard;
  float depth = texelFetch(scene_depth, ivec2(gl_FragCoord.xy) * side + side / 2, 0).r;
  bool seen = (gl_FragCoord.z - depth) * nearer >= -slack - 1e-5 * depth;
  mask = strength * (seen ? 1.0 : 0.35);
}
