// Draws triangles into a mask: `strength` if visible, less if occluded.
#include "texel.glsl"
uniform sampler2D scene_depth;
uniform int side;        // samples per pixel side
uniform float nearer;    // 1 if larger depths are nearer (reversed depth), else -1
uniform float strength;  // 0 … 1; below 1 for selections that the next command does not affect
layout(location = 0) out float mask;

void main() {
  // Outside any branch: derivatives need all four pixels of a quad.
  float slack = 2.0 * fwidth(gl_FragCoord.z);
  uvec2 texel = texel_here();
  if ((texel.r & 255u) == 0u) discard;
  float depth = texelFetch(scene_depth, ivec2(gl_FragCoord.xy) * side + side / 2, 0).r;
  bool seen = (gl_FragCoord.z - depth) * nearer >= -slack - 1e-5 * depth;
  mask = strength * (seen ? 1.0 : 0.35);
}
