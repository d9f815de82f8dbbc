// The texel of a fragment. A triangle's texels are a rectangle of the texture, which lies elsewhere on the GPU.
uniform usampler2D features;
in vec2 at_texel;        // in texels of the texture, v down
flat in uvec3 packed_at;  // the rectangle's first texel, its last one, where the first one lies: x in the low halves

ivec2 halves(uint both) { return ivec2(both & 0xffffu, both >> 16); }

uvec2 texel_here() {
  ivec2 first = halves(packed_at.x);
  ivec2 texel = clamp(ivec2(floor(at_texel)), first, halves(packed_at.y)) - first + halves(packed_at.z);
  return texelFetch(features, texel, 0).rg;
}
