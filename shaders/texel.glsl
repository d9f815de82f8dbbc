// Fetches the texel of a fragment, clamped to its triangle's rectangle, which is packed or coded on the GPU.
#if CODED_TEXELS
uniform usamplerBuffer texel_blocks;  // TexelBlock in render/gpu_scene/coded_texels.h
uniform usamplerBuffer texel_words;   // 32-bit halves of CodedTexels::words
#else
uniform usampler2D features;
#endif
in vec2 at_texel;         // texture coordinates in texels, v down
flat in uvec3 packed_at;  // first and last texel of the rectangle, its place on the GPU: x in the low halves

ivec2 halves(uint both) { return ivec2(both & 0xffffu, both >> 16); }

#if CODED_TEXELS
uint width_of(uint widths, int channel) {
  uint code = (widths >> (3 * channel)) & 7u;
  return code + uint(code == 7u);
}

// Number of bits that are set in the low 16.
uint ones(uint bits) {
  bits -= (bits >> 1) & 0x5555u;
  bits = (bits & 0x3333u) + ((bits >> 2) & 0x3333u);
  bits = (bits + (bits >> 4)) & 0x0f0fu;
  return (bits + (bits >> 8)) & 31u;
}

uvec2 texel_here() {
  ivec2 first = halves(packed_at.x), last = halves(packed_at.y);
  ivec2 texel = clamp(ivec2(floor(at_texel)), first, last) - first;
  // Number of the texel along the rectangle's strips, which alternate in direction.
  ivec2 size = last - first + 1;
  int last_strip = max(size.y >> 2, 1) - 1;
  int strip = min(texel.y >> 2, last_strip);
  int rows = strip == last_strip ? size.y - 4 * strip : 4;
  int column = (strip & 1) == 0 ? texel.x : size.x - 1 - texel.x;
  int number = 4 * strip * size.x + column * rows + texel.y - 4 * strip;
  // The place is the index of the rectangle's first block.
  uvec4 block = texelFetch(texel_blocks, int(packed_at.z) + (number >> 4));
  number &= 15;
  if (((block.x >> number) & 1u) == 0u) return uvec2(0u);
  uint widths = (block.x >> 16) | (block.y << 16);
  uint bits = 0u;
  for (int channel = 0; channel < 8; ++channel) bits += width_of(widths, channel);
  uint at = (block.y >> 8) * 64u + ones(block.x & ((1u << number) - 1u)) * bits;
  int word = int(at >> 5);
  uint shift = at & 31u;
  uint a = texelFetch(texel_words, word).r, b = texelFetch(texel_words, word + 1).r,
       c = texelFetch(texel_words, word + 2).r;
  // Shifts in two steps, because a shift by 32 is undefined.
  uvec2 left = uvec2((a >> shift) | (b << 1) << (31u - shift), (b >> shift) | (c << 1) << (31u - shift));
  uvec2 found = block.zw;
  for (int channel = 0; channel < 8; ++channel) {
    uint width = width_of(widths, channel);
    uint over = left.x & ((1u << width) - 1u);
    left = uvec2((left.x >> width) | (left.y << 1) << (31u - width), left.y >> width);
    if (channel < 4)
      found.x += over << (8 * channel);
    else
      found.y += over << (8 * (channel - 4));
  }
  return found;
}
#else
uvec2 texel_here() {
  ivec2 first = halves(packed_at.x);
  ivec2 texel = clamp(ivec2(floor(at_texel)), first, halves(packed_at.y)) - first + halves(packed_at.z);
  return texelFetch(features, texel, 0).rg;
}
#endif
