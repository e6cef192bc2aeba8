// Lines between nodes of a body: beams, and outlines of plates.
layout(location = 0) in uvec2 ends;
uniform float width; // pixels
uniform float nearer; // in depth, so that an outline lies on its plate

void main() {
  vec4 a = toClip * vec4(placed(int(ends.x)), 1.0);
  vec4 b = toClip * vec4(placed(int(ends.y)), 1.0);
  gl_Position = widened(a, b, vec2(width), nearer);
}
