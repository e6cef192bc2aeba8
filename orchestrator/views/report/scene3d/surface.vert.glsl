// Vertices in the axes of their body, by its pose; a shadow lies on the ground.
precision highp float;
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 look; // coordinates in cells, and face: 1 with cells, -1 without, 0 of no plate
layout(location = 2) in float stress; // Pa
uniform vec3 position; // m, of the body's axes in the world
uniform vec4 orientation; // unit quaternion, scalar first
uniform vec3 size; // factors along the body's axes
uniform mat4 toClip;
uniform vec3 light;
uniform float ground; // m
uniform bool isShadow;
out vec3 place;
out vec3 looks;
out float vonMises;

void main() {
  vec3 own = at * size;
  vec3 twice = 2.0 * cross(orientation.yzw, own);
  place = position + own + orientation.x * twice + cross(orientation.yzw, twice);
  if (isShadow) place -= light * (place.z - ground) / light.z;
  looks = look;
  vonMises = stress;
  gl_Position = toClip * vec4(place, 1.0);
}
