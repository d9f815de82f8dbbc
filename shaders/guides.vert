layout(location = 0) in vec3 position;  // camera space
layout(location = 1) in vec4 color;
layout(location = 2) in float hidden;   // opacity if occluded; -1: draw only on a visible surface at this depth
uniform mat4 camera_to_clip;
uniform float thickness;        // tolerance within which a surface is at this depth, as a share of its distance
uniform float nearer;           // 1 for reversed depth, which is 0 … 1; else -1, and clip depth is -1 … 1
out vec4 line_color;
out float hidden_opacity;
noperspective out float layer;  // `thickness` as a difference of depth

void main() {
  gl_Position = camera_to_clip * vec4(position, 1.0);
  line_color = color;
  hidden_opacity = hidden;
  vec4 back = camera_to_clip * vec4(position * (1.0 + thickness), 1.0);
  layer = gl_Position.w > 0.0 ? (back.z / back.w - gl_Position.z / gl_Position.w) * (nearer > 0.0 ? 1.0 : 0.5) : 0.0;
}
