// The eye: it turns about a point, z up.

const HALF_ANGLE = Math.tan((14 * Math.PI) / 180);
const RADIAN = Math.PI / 180;
const FILLED = 0.9; // of the picture, that what is shown fills in the longer of its directions

class Camera {
  /** points: all that is to be seen, m; size: low and high corners of it. */
  constructor(points, low, high) {
    this.points = points;
    this.size = Math.max(length(minus(high, low)), 1e-6);
    this.center = times(0.5, plus(low, high));
    this.wide = high[0] - low[0] >= high[1] - low[1];
    this.reset();
  }

  /** The first view: three quarters of the way to the longer horizontal axis, and following what there is. */
  reset() {
    this.look(this.wide ? -52 : 38, 24);
    this.follows = true;
  }

  /** Look from a side; angles in degrees about z and above the horizon. */
  look(azimuth, elevation) {
    this.azimuth = azimuth * RADIAN;
    this.elevation = elevation * RADIAN;
  }

  /** See all points from the side of now. */
  fit(aspect, points = this.points) {
    this.target = this.center;
    const { right, up, back } = this.axes();
    for (let round = 0; round < 3; round++) {
      const away = points.map(point => minus(point, this.target));
      const distances = away.map(a => dot(a, back) + Math.max(Math.abs(dot(a, right)) / aspect, Math.abs(dot(a, up))) / (HALF_ANGLE * FILLED));
      this.distance = Math.max(0.02 * this.size, ...distances);
      const seen = away.map(a => times(this.distance / (this.distance - dot(a, back)), [dot(a, right), dot(a, up), 0]));
      const middle = axis => 0.5 * (Math.max(...seen.map(s => s[axis])) + Math.min(...seen.map(s => s[axis])));
      if (round < 2) this.target = plus(this.target, plus(times(middle(0), right), times(middle(1), up)));
    }
  }

  axes() {
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    return { right: [-sa, ca, 0], up: [-ca * se, -sa * se, ce], back: [ca * ce, sa * ce, se] };
  }

  get eye() {
    return plus(this.target, times(this.distance, this.axes().back));
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.max(this.elevation + elevation, -Math.PI / 2), Math.PI / 2);
  }

  /** Shift by parts of the picture's height. */
  shift(right, up) {
    this.follows = false;
    const axes = this.axes();
    const height = 2 * HALF_ANGLE * this.distance;
    this.target = plus(this.target, plus(times(right * height, axes.right), times(up * height, axes.up)));
  }

  zoom(factor) {
    this.follows = false;
    this.distance = Math.min(Math.max(this.distance * factor, 1e-3 * this.size), 50 * this.size);
  }

  /** From the world to the cube that is seen. */
  toClip(aspect) {
    const { right, up, back } = this.axes();
    const far = this.distance + 4 * this.size;
    const near = Math.max(this.distance - 4 * this.size, 0.01 * this.distance);
    return multiplied(perspective(HALF_ANGLE, aspect, near, far), seenFrom(this.eye, right, up, back));
  }
}
