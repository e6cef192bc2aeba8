// Nodes of plates: their places, and von Mises stress of the face where it is larger.
uniform sampler2D stresses; // (coordinate x 2 + face) x nodeCount + node: sx, sy, txy in Pa
uniform int coordinateCount; // 0 where no stress is known
out vec3 place;
out float vonMises;

float squared(vec3 s) {
  return 0.5 * (s.x * s.x + s.y * s.y + (s.x - s.y) * (s.x - s.y)) + 3.0 * s.z * s.z;
}

void main() {
  vec3 upper = vec3(0.0);
  vec3 lower = vec3(0.0);
  for (int k = 0; k < coordinateCount; k++) {
    float weight = number(state, formCount + k).x;
    upper += weight * number(stresses, 2 * k * nodeCount + gl_VertexID).xyz;
    lower += weight * number(stresses, (2 * k + 1) * nodeCount + gl_VertexID).xyz;
  }
  vonMises = sqrt(max(squared(upper), squared(lower)));
  place = placed(gl_VertexID);
  gl_Position = toClip * vec4(place, 1.0);
}
