// Sums of texel bytes, two channels in each component: 64 samples of 255 fit in 16 bits.
struct Sums {
  uvec4 bytes;  // feat0 R and B, feat0 G and A, feat1 R and B, feat1 G and A
  uint count;
};

void add(inout Sums sums, uvec2 texel) {
  sums.bytes += uvec4(texel.r & 0xff00ffu, (texel.r >> 8) & 0xff00ffu, texel.g & 0xff00ffu, (texel.g >> 8) & 0xff00ffu);
  sums.count += 1u;
}

// Averages over `samples`, covered or not. alpha_code is (factor, offset) of the stored alpha: (2, -1) halved, (1, 0) plain.
void average(Sums sums, float samples, vec2 alpha_code, out vec4 low, out vec4 high) {
  vec4 even = vec4(sums.bytes & 0xffffu);
  vec4 odd = vec4(sums.bytes >> 16);
  low = vec4(even.x, even.y, odd.x, odd.y) / (255.0 * samples);
  high = vec4(even.z, even.w, odd.z, odd.w) / (255.0 * samples);
  float bias = alpha_code.y * float(sums.count) / samples;
  low.w = low.w * alpha_code.x + bias;
  high.w = high.w * alpha_code.x + bias;
}
