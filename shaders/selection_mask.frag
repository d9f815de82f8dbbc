// Selected triangles into a mask: 1 where they are seen, less where something lies in front.
uniform usampler2D features;
uniform ivec2 last_texel;
uniform sampler2D scene_depth;
uniform int side;       // samples along a pixel's side
uniform float nearer;   // 1 where larger depths are nearer, else -1
in vec2 at_texel;
layout(location = 0) out float mask;

void main() {
  // Outside any branch: derivatives need all four pixels.
  float slack = 2.0 * fwidth(gl_FragCoord.z);
  uvec2 texel = texelFetch(features, clamp(ivec2(floor(at_texel)), ivec2(0), last_texel), 0).rg;
  if ((texel.r & 255u) == 0u) discard;
  float depth = texelFetch(scene_depth, ivec2(gl_FragCoord.xy) * side + side / 2, 0).r;
  bool seen = (gl_FragCoord.z - depth) * nearer >= -slack - 1e-5 * depth;
  mask = seen ? 1.0 : 0.35;
}
