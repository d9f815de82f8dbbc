// PlenOctree: crosses the leaves of a sparse octree; each has a density and spherical harmonics. Rules: PlenOctree.
// BASIS: number of harmonics. RECORD: texels per record of `values`.
#include "studies/view_ray.glsl"

uniform isamplerBuffer children;  // [node][child]: > 0 a node, 0 an empty leaf, < 0 record −1 − value
uniform samplerBuffer values;     // [record]: BASIS coefficients each of red, green and blue; density
uniform vec3 tree_offset, tree_scale;

out vec4 picture;

const int most_steps = 65536;  // more than leaves of 16 levels along a ray that is not degenerate
const float smallest_density = 0.01, smallest_light = 0.01;

void harmonics(vec3 d, out float basis[BASIS]) {
  basis[0] = 0.28209479177387814;
#if BASIS > 1
  basis[1] = -0.4886025119029199 * d.y;
  basis[2] = 0.4886025119029199 * d.z;
  basis[3] = -0.4886025119029199 * d.x;
#endif
#if BASIS > 4
  basis[4] = 1.0925484305920792 * d.x * d.y;
  basis[5] = -1.0925484305920792 * d.y * d.z;
  basis[6] = 0.31539156525252005 * (2.0 * d.z * d.z - d.x * d.x - d.y * d.y);
  basis[7] = -1.0925484305920792 * d.x * d.z;
  basis[8] = 0.5462742152960396 * (d.x * d.x - d.y * d.y);
#endif
#if BASIS > 9
  basis[9] = -0.5900435899266435 * d.y * (3.0 * d.x * d.x - d.y * d.y);
  basis[10] = 2.890611442640554 * d.x * d.y * d.z;
  basis[11] = -0.4570457994644658 * d.y * (4.0 * d.z * d.z - d.x * d.x - d.y * d.y);
  basis[12] = 0.3731763325901154 * d.z * (2.0 * d.z * d.z - 3.0 * d.x * d.x - 3.0 * d.y * d.y);
  basis[13] = -0.4570457994644658 * d.x * (4.0 * d.z * d.z - d.x * d.x - d.y * d.y);
  basis[14] = 1.445305721320277 * d.z * (d.x * d.x - d.y * d.y);
  basis[15] = -0.5900435899266435 * d.x * (d.x * d.x - 3.0 * d.y * d.y);
#endif
}

vec3 march(vec3 direction) {
  vec3 origin = tree_offset + tree_scale * eye, inside = tree_scale * direction;
  float stretch = length(inside);
  inside /= stretch;
  vec3 inverse_direction = 1.0 / inside;
  vec2 range = box_range(vec3(0.0), vec3(1.0), origin, inverse_direction);
  if (range.x > range.y) return vec3(1.0);
  float basis[BASIS];
  harmonics(direction, basis);
  vec3 color = vec3(0.0);
  // Parameters count from where the ray enters the cube, so that they are small.
  origin += inside * max(0.0, range.x);
  float light = 1.0, t = 0.0, end = range.y - max(0.0, range.x);
  for (int steps = 0; steps < most_steps && t < end; ++steps) {
    vec3 within = clamp(origin + t * inside, 0.0, 0.9999999), corner = vec3(0.0);
    float size = 1.0;
    int node = 0, child = 1;
    while (child > 0) {
      within *= 2.0;
      size *= 0.5;
      ivec3 octant = min(ivec3(within), 1);
      within -= vec3(octant);
      corner += size * vec3(octant);
      child = texelFetch(children, node * 8 + 4 * octant.x + 2 * octant.y + octant.z).r;
      node = child;
    }
    float leave = max(box_range(corner, corner + size, origin, inverse_direction).y, t), nudge = max(size * 1e-3, t * 2e-7);
    if (child < 0) {
      int record = -1 - child;
      vec4 data[RECORD];
      data[RECORD - 1] = texelFetch(values, record * RECORD + RECORD - 1);
      float density = data[RECORD - 1][(3 * BASIS) % 4];
      if (density > smallest_density) {
        float through = exp(-(leave + nudge - t) / stretch * density);
        for (int k = 0; k < RECORD - 1; ++k) data[k] = texelFetch(values, record * RECORD + k);
        vec3 sum = vec3(0.0);
        for (int b = 0; b < BASIS; ++b) {
          int red = b, green = BASIS + b, blue = 2 * BASIS + b;
          sum += basis[b] * vec3(data[red / 4][red % 4], data[green / 4][green % 4], data[blue / 4][blue % 4]);
        }
        color += light * (1.0 - through) / (1.0 + exp(-sum));
        light *= through;
        if (light < smallest_light) return color / (1.0 - light);
      }
    }
    t = leave + nudge;
  }
  return color + light;
}

void main() {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < side * side; ++k) sum += march(view_direction(k));
  picture = vec4(sum / float(side * side), 1.0);
}
