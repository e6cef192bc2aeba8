// Where a node is: the pose of its body, and the sum of its forms. Put before the vertex shaders that ask for it.
precision highp float;
precision highp int;
precision highp sampler2D;

const int WIDTH = 2048; // of a texture with a long row of numbers, as every WebGL2 has it
uniform sampler2D nodes; // node
uniform sampler2D forms; // form x nodeCount + node
uniform sampler2D state; // amplitudes, then coordinates of stress
uniform int nodeCount;
uniform int formCount;
uniform vec3 position; // m, of the body's axes in the world
uniform vec4 orientation; // unit quaternion, scalar first
uniform mat4 toClip;

vec4 number(sampler2D rows, int k) {
  return texelFetch(rows, ivec2(k % WIDTH, k / WIDTH), 0);
}

vec3 placed(int node) {
  vec3 bent = number(nodes, node).xyz;
  for (int k = 0; k < formCount; k++) {
    bent += number(forms, k * nodeCount + node).xyz * number(state, k).x;
  }
  vec3 twice = 2.0 * cross(orientation.yzw, bent);
  return position + bent + orientation.x * twice + cross(orientation.yzw, twice);
}
