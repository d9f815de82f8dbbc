uniform sampler2D scene_depth;
uniform int side;      // samples per pixel side
uniform float nearer;  // 1 if larger depths are nearer (reversed depth), else -1
uniform bool empty;    // nothing was drawn: there is no depth
in vec4 line_color;
in float hidden_opacity;
noperspective in float layer;
out vec4 color;

void main() {
  float depth = texelFetch(scene_depth, ivec2(gl_FragCoord.xy) * side + side / 2, 0).r;
  bool seen = empty || (gl_FragCoord.z - depth) * nearer >= 0.0;
  if (hidden_opacity < 0.0 && (empty || !seen || (gl_FragCoord.z + layer - depth) * nearer > 0.0)) discard;
  color = vec4(line_color.rgb, seen ? line_color.a : hidden_opacity);
}
