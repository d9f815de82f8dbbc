// Sums of texel bytes, two channels per component: the sum of 64 bytes fits in 16 bits.
struct Sums {
  uvec4 bytes;  // feat0 R and B, feat0 G and A, feat1 R and B, feat1 G and A
  uint count;
};

void add(inout Sums sums, uvec2 texel) {
  sums.bytes += uvec4(texel.r & 0xff00ffu, (texel.r >> 8) & 0xff00ffu, texel.g & 0xff00ffu, (texel.g >> 8) & 0xff00ffu);
  sums.count += 1u;
}

// Features 0 … 3 (low) and 4 … 7 (high), averaged over `samples`; uncovered samples count as 0. alpha_code: factor and
// offset that decode the stored alpha, (2, -1) if halved and (1, 0) if plain.
void average(Sums sums, float samples, vec2 alpha_code, out vec4 low, out vec4 high) {
  vec4 even = vec4(sums.bytes & 0xffffu);
  vec4 odd = vec4(sums.bytes >> 16);
  low = vec4(even.x, even.y, odd.x, odd.y) / (255.0 * samples);
  high = vec4(even.z, even.w, odd.z, odd.w) / (255.0 * samples);
  float bias = alpha_code.y * float(sums.count) / samples;
  low.w = low.w * alpha_code.x + bias;
  high.w = high.w * alpha_code.x + bias;
}
