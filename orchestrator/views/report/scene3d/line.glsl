// A line as a strip of a width on the screen. Put before the vertex shaders of lines.
uniform vec2 screen; // pixels
const float CORNER_END[6] = float[](0.0, 1.0, 0.0, 0.0, 1.0, 1.0);
const float CORNER_SIDE[6] = float[](-1.0, -1.0, 1.0, 1.0, -1.0, 1.0);

vec4 widened(vec4 a, vec4 b, vec2 widths, float nearer) {
  float near = 1e-4;
  // what is behind the eye is cut off before it is divided
  if (a.w < near && b.w < near) return vec4(2.0, 2.0, 2.0, 1.0);
  if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * screen;
  float size = length(along);
  vec2 across = size > 1e-6 ? vec2(-along.y, along.x) / size : vec2(0.0, 1.0);
  float end = CORNER_END[gl_VertexID];
  vec4 place = mix(a, b, end);
  place.xy += CORNER_SIDE[gl_VertexID] * mix(widths.x, widths.y, end) * across / screen * place.w;
  place.z -= nearer * place.w;
  return place;
}
