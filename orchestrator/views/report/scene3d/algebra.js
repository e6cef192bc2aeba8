// Vectors, unit quaternions (scalar first) and 4 x 4 matrices (by columns, as WebGL takes them).

const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = a => Math.hypot(a[0], a[1], a[2]);
const unit = a => times(1 / (length(a) || 1), a);

/** A vector turned by a quaternion. */
const turned = (q, a) => {
  const axis = [q[1], q[2], q[3]];
  const twice = times(2, cross(axis, a));
  return plus(plus(a, times(q[0], twice)), cross(axis, twice));
};

/** The quaternion at a place between two rows of four numbers, which are near each other and on one side. */
const mixed = (values, place) => {
  const found = interpolated(values, 4, place, [0, 0, 0, 0]);
  const size = Math.hypot(...found);
  return found.map(value => value / size);
};

/** The quaternion of one turn after another: the second first. */
const after = (a, b) => {
  const [u, v] = [[a[1], a[2], a[3]], [b[1], b[2], b[3]]];
  return [a[0] * b[0] - dot(u, v), ...plus(plus(times(a[0], v), times(b[0], u)), cross(u, v))];
};

/** A quaternion that turns x into a direction. */
const fromX = direction => {
  const [x, y, z] = unit(direction);
  const found = x > -0.999999 ? [1 + x, 0, -z, y] : [0, 0, 0, 1];
  const size = Math.hypot(...found);
  return found.map(value => value / size);
};

/** Rows of the matrix of a unit quaternion. */
const rowsOf = ([w, x, y, z]) => [
  1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
  2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
  2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
];

const multiplied = (a, b) => {
  const found = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      found[4 * column + row] = sum;
    }
  }
  return found;
};

/** Perspective with a vertical half angle of this tangent; depth from near to far. */
const perspective = (tangent, aspect, near, far) => new Float32Array([
  1 / (tangent * aspect), 0, 0, 0,
  0, 1 / tangent, 0, 0,
  0, 0, (far + near) / (near - far), -1,
  0, 0, (2 * far * near) / (near - far), 0,
]);

/** From the world to axes with x to the right, y up and z towards the eye. */
const seenFrom = (eye, right, up, back) => new Float32Array([
  right[0], up[0], back[0], 0,
  right[1], up[1], back[1], 0,
  right[2], up[2], back[2], 0,
  -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
]);
