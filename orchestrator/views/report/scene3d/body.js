// A body that moves: poses and amplitudes at few times, and what follows from them at any time.

class Body {
  constructor(content, colour) {
    this.name = content.name;
    this.colour = colour;
    this.nodes = decoded(content.nodes);
    this.count = content.nodes.shape[0];
    this.formCount = content.forms.shape[1];
    this.forms = decoded(content.forms); // (node, axis) by form
    this.triangles = decoded(content.triangles);
    this.lines = decoded(content.lines);
    this.outline = decoded(content.outline);
    this.clock = decoded(content.time);
    this.positions = decoded(content.position);
    this.orientations = decoded(content.orientation);
    this.amplitudeRows = decoded(content.amplitudes);
    this.scales = content.scales;
    this.stress = content.stress && new Stress(content.stress);
    this.position = [0, 0, 0];
    this.orientation = [1, 0, 0, 0];
    this.amplitudes = new Float32Array(this.formCount);
  }

  /** Take the pose and the amplitudes of a time (s); deformation times a factor. */
  move(time, factor) {
    const place = between(this.clock, time);
    interpolated(this.positions, 3, place, this.position);
    this.orientation = mixed(this.orientations, place);
    interpolated(this.amplitudeRows, this.formCount, place, this.amplitudes);
    if (this.scales) for (let k = 0; k < this.formCount; k++) this.amplitudes[k] *= factor;
    if (this.stress) this.stress.move(time);
  }

  /** A node as the body's own axes have it, bent. */
  bent(node) {
    const found = [0, 0, 0];
    for (let axis = 0; axis < 3; axis++) {
      const row = 3 * node + axis;
      found[axis] = this.nodes[row];
      for (let k = 0; k < this.formCount; k++) found[axis] += this.forms[row * this.formCount + k] * this.amplitudes[k];
    }
    return found;
  }

  placed(point) {
    return plus(this.position, turned(this.orientation, point));
  }

  /** The node nearest to a point of the body at rest. */
  nodeNear(point) {
    let best = 0;
    let least = Infinity;
    for (let node = 0; node < this.count; node++) {
      const away = length(minus(point, Array.from(this.nodes.subarray(3 * node, 3 * node + 3))));
      if (away < least) [best, least] = [node, away];
    }
    return best;
  }
}

/** Stresses of a plate: six rows a node (sx, sy, txy of the upper face, then of the lower one) by coordinates. */
class Stress {
  constructor(content) {
    this.columns = content.rows.shape[1];
    this.rows = decoded(content.rows);
    this.clock = decoded(content.time);
    this.history = decoded(content.coordinates);
    this.peak = content.peak;
    this.shownPeak = content.shown_peak;
    this.tolerance = content.tolerance;
    this.coordinates = new Float32Array(this.columns);
  }

  move(time) {
    interpolated(this.history, this.columns, between(this.clock, time), this.coordinates);
  }

  /** Largest von Mises stress (Pa) of any node, of both faces, as the shader finds it. */
  largest() {
    let most = 0;
    const face = [0, 0, 0];
    for (let first = 0; first < this.rows.length; first += 3 * this.columns) {
      for (let part = 0; part < 3; part++) {
        const start = first + part * this.columns;
        face[part] = 0;
        for (let k = 0; k < this.columns; k++) face[part] += this.rows[start + k] * this.coordinates[k];
      }
      const [sx, sy, txy] = face;
      most = Math.max(most, 0.5 * (sx * sx + sy * sy + (sx - sy) * (sx - sy)) + 3 * txy * txy);
    }
    return Math.sqrt(most);
  }
}

/** A point fixed to a body near one of its nodes, or to the world. */
class Point {
  constructor(place, bodies) {
    this.body = bodies.find(body => body.name === place.body) || null;
    this.rest = place.point;
    if (this.body) {
      this.node = this.body.nodeNear(place.point);
      this.arm = minus(place.point, Array.from(this.body.nodes.subarray(3 * this.node, 3 * this.node + 3)));
    }
  }

  /** Where it is in the world now. */
  here() {
    return this.body ? this.body.placed(plus(this.body.bent(this.node), this.arm)) : this.rest;
  }

  /** A direction of the body, as the world sees it now. */
  direction(axis) {
    return this.body ? turned(this.body.orientation, axis) : axis;
  }
}
