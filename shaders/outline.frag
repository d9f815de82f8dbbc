// Draws an outline around marked pixels, fainter where they are occluded. It is light inside and dark outside, so that
// it is visible on any colour.
uniform sampler2D mask;
out vec4 color;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(mask, 0) - 1;
  float inner = 0.0, outer = 0.0;
  for (int dy = -3; dy <= 3; ++dy)
    for (int dx = -3; dx <= 3; ++dx) {
      float there = texelFetch(mask, clamp(pixel + ivec2(dx, dy), ivec2(0), last), 0).r;
      int distance2 = dx * dx + dy * dy;
      if (distance2 <= 4) inner = max(inner, there);
      if (distance2 <= 10) outer = max(outer, there);
    }
  if (texelFetch(mask, pixel, 0).r > 0.0 || outer == 0.0) discard;
  color = inner > 0.0 ? vec4(1.0, 0.72, 0.24, inner) : vec4(0.08, 0.05, 0.0, 0.45 * outer);
}
