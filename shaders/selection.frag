// Tints marked pixels and draws an outline around them. Stripes keep the tint visible on surfaces of the same colour.
uniform sampler2D mask;
out vec4 color;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(mask, 0) - 1;
  float here = texelFetch(mask, pixel, 0).r, around = 0.0;
  for (int k = 0; k < 8; ++k) {
    ivec2 step = ivec2(k < 3 ? -1 : k < 5 ? 0 : 1, k < 3 ? k - 1 : k < 5 ? (k - 3) * 2 - 1 : k - 6);
    around = max(around, texelFetch(mask, clamp(pixel + step, ivec2(0), last), 0).r);
  }
  if (here == 0.0 && around == 0.0) discard;
  bool stripe = (pixel.x + pixel.y) % 8 < 2;
  vec4 tint = stripe ? vec4(0.3, 0.1, 0.0, 0.4 * here) : vec4(1.0, 0.5, 0.05, 0.5 * here);
  color = here > 0.0 ? tint : vec4(0.25, 0.08, 0.0, around);
}
