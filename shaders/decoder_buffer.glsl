// Decoder with weights from a buffer. Texel k of decoder_layout: index of the first weight of decoder k, hidden widths,
// and the rule as ColorRule in mesh_ops/texture/decoder.h.
uniform samplerBuffer decoder_weights;
uniform samplerBuffer decoder_layout;

float weight(int at) { return texelFetch(decoder_weights, at >> 2)[at & 3]; }

vec3 decode(int k, vec4 low, vec4 high, vec3 ray) {
  ivec4 layout_of = ivec4(texelFetch(decoder_layout, k));
  int at = layout_of.x;
  if (layout_of.w != 0) {
    float share = low.x;
    low /= share;
    high /= share;
    ray /= share;
    if (layout_of.w == 2) return low.yzw;
  }
  float x[11] = float[11](low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w, ray.x, ray.y, ray.z);
  float first[WIDEST_LAYER];
  float second[WIDEST_LAYER];
  // Per neuron: its bias, then its weights.
  for (int j = 0; j < layout_of.y; ++j) {
    float sum = weight(at++);
    for (int i = 0; i < 11; ++i) sum += weight(at++) * x[i];
    first[j] = max(sum, 0.0);
  }
  for (int j = 0; j < layout_of.z; ++j) {
    float sum = weight(at++);
    for (int i = 0; i < layout_of.y; ++i) sum += weight(at++) * first[i];
    second[j] = max(sum, 0.0);
  }
  vec3 color;
  for (int c = 0; c < 3; ++c) {
    float sum = weight(at++);
    for (int i = 0; i < layout_of.z; ++i) sum += weight(at++) * second[i];
    color[c] = 1.0 / (1.0 + exp(-sum));
  }
  return layout_of.w == 0 ? color : min(low.yzw + color, 1.0);
}
