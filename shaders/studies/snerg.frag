// Sparse neural radiance grid: marches an atlas of occupied blocks in steps of one voxel, then decodes once per ray.
// view_dependence(), in front of this file, is the decoder. Rules: SnergScene.
#include "studies/view_ray.glsl"

uniform sampler3D blocks;    // place of each block in the atlas; red 255: empty
uniform sampler3D occupied;  // of 4×4×4 texels of the atlas: 0 if all within one texel have no opacity
uniform sampler3D colors;    // premultiplied, and opacity
uniform sampler3D features;  // premultiplied
uniform vec3 grid_min, grid_size, atlas_size;
uniform float voxel_size, block_size;
uniform mat3 world_from_opengl;

out vec4 picture;

vec3 march(vec3 direction) {
  vec3 origin = (eye - grid_min) / voxel_size, inverse_direction = 1.0 / direction;
  vec2 range = box_range(vec3(0.0), grid_size, origin, inverse_direction);
  if (range.x > range.y) return vec3(1.0);
  ivec3 last_block = textureSize(blocks, 0) - 1;
  vec3 color = vec3(0.0);
  vec4 feature = vec4(0.0);
  float visibility = 1.0, t = max(0.0, range.x) + 0.5, leave = -1.0;
  vec3 low, place;
  int most = int(ceil(length(grid_size)));
  for (int steps = 0; steps < most && t < range.y && visibility > 1.0 / 255.0; ++steps) {
    vec3 at = origin + direction * t;
    if (t > leave) {
      low = floor(at / block_size) * block_size;
      leave = box_range(low, low + block_size, origin, inverse_direction).y;
      place = 255.0 * texelFetch(blocks, clamp(ivec3(at / block_size), ivec3(0), last_block), 0).rgb;
    }
    if (place.x > 254.0) {
      t = 0.5 + max(leave, t);
      continue;
    }
    vec3 texel = clamp(at - low, 0.0, block_size) + place * (block_size + 2.0) + 1.0;
    if (texelFetch(occupied, ivec3(texel) / 4, 0).r > 0.0) {
      vec4 sampled = texture(colors, texel / atlas_size);
      if (sampled.a > 0.5 / 255.0) {
        color += visibility * sampled.rgb;
        feature += visibility * texture(features, texel / atlas_size);
        visibility *= 1.0 - sampled.a;
      }
    }
    t += 1.0;
  }
  color += visibility;
  if (visibility > 254.0 / 255.0) return color;
  return color + view_dependence(color, feature, world_from_opengl * direction);
}

void main() {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < side * side; ++k) sum += min(march(view_direction(k)), 1.0);
  picture = vec4(sum / float(side * side), 1.0);
}
