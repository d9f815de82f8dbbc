layout(location = 0) in vec3 position;   // camera space
layout(location = 1) in vec4 color;
layout(location = 2) in float hidden;    // opacity where something lies in front; -1: shows on the surface there only
uniform mat4 camera_to_clip;
uniform float thickness;    // of the layer in which a surface counts as there, as a share of its distance
uniform float nearer;       // 1 where larger depths are nearer, which then lie in 0 … 1; else -1 and -1 … 1
out vec4 line_color;
out float hidden_opacity;
noperspective out float layer;  // depth from here to the back of that layer

void main() {
  gl_Position = camera_to_clip * vec4(position, 1.0);
  line_color = color;
  hidden_opacity = hidden;
  vec4 back = camera_to_clip * vec4(position * (1.0 + thickness), 1.0);
  layer = gl_Position.w > 0.0 ? (back.z / back.w - gl_Position.z / gl_Position.w) * (nearer > 0.0 ? 1.0 : 0.5) : 0.0;
}
