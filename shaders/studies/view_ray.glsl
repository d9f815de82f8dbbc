uniform vec3 eye;
uniform mat3 camera_axes;  // right, up, back
uniform vec2 half_extent;  // of the picture at depth 1
uniform vec2 picture_size;
uniform int side;  // samples per pixel side

// Unit direction of the view ray through sample k of this pixel.
vec3 view_direction(int k) {
  vec2 at = floor(gl_FragCoord.xy) + (vec2(k % side, k / side) + 0.5) / float(side);
  return normalize(camera_axes * vec3((at / picture_size * 2.0 - 1.0) * half_extent, -1.0));
}

// Parameters at which a ray enters and leaves a box.
vec2 box_range(vec3 low, vec3 high, vec3 origin, vec3 inverse_direction) {
  vec3 a = (low - origin) * inverse_direction, b = (high - origin) * inverse_direction;
  vec3 enter = min(a, b), leave = max(a, b);
  return vec2(max(enter.x, max(enter.y, enter.z)), min(leave.x, min(leave.y, leave.z)));
}
