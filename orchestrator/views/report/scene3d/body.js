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
    this.thickness = content.thickness || 0;
    this.isBase = Boolean(content.is_base);
    this.clock = decoded(content.time);
    this.positions = decoded(content.position);
    this.orientations = decoded(content.orientation);
    this.amplitudeRows = decoded(content.amplitudes);
    this.scales = content.scales;
    this.stress = content.stress && new Stress(content.stress);
    this.position = [0, 0, 0];
    this.orientation = [1, 0, 0, 0];
    this.amplitudes = new Float32Array(this.formCount);
    this.spots = Float32Array.from(this.nodes); // nodes as they are bent now, in the axes of the body
  }

  /** Take the pose and the amplitudes of a time (s); deformation times a factor. */
  move(time, factor) {
    const place = between(this.clock, time);
    interpolated(this.positions, 3, place, this.position);
    this.orientation = mixed(this.orientations, place);
    interpolated(this.amplitudeRows, this.formCount, place, this.amplitudes);
    if (this.scales) for (let k = 0; k < this.formCount; k++) this.amplitudes[k] *= factor;
    if (this.formCount) this.bend();
    if (this.stress) this.stress.move(time);
  }

  bend() {
    const { spots, nodes, forms, amplitudes, formCount } = this;
    for (let row = 0, first = 0; row < spots.length; row++, first += formCount) {
      let sum = nodes[row];
      for (let k = 0; k < formCount; k++) sum += forms[first + k] * amplitudes[k];
      spots[row] = sum;
    }
  }

  /** A node as the body's own axes have it, bent. */
  bent(node) {
    return [this.spots[3 * node], this.spots[3 * node + 1], this.spots[3 * node + 2]];
  }

  /** Where a point near a node is in the world at another time, without deformation scaled. */
  placedAt(time, node, arm) {
    const place = between(this.clock, time);
    const amplitudes = interpolated(this.amplitudeRows, this.formCount, place, new Float32Array(this.formCount));
    const bent = [0, 1, 2].map(axis => {
      const row = 3 * node + axis;
      let sum = this.nodes[row] + arm[axis];
      for (let k = 0; k < this.formCount; k++) sum += this.forms[row * this.formCount + k] * amplitudes[k];
      return sum;
    });
    return plus(interpolated(this.positions, 3, place, [0, 0, 0]), turned(mixed(this.orientations, place), bent));
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
    this.vonMises = new Float32Array(content.rows.shape[0] / 6);
    [this.where, this.largest] = [0, 0];
  }

  move(time) {
    interpolated(this.history, this.columns, between(this.clock, time), this.coordinates);
  }

  /** Von Mises stress (Pa) of every node, of the face where it is larger; where it is largest of all. */
  field() {
    const { rows, columns, coordinates, vonMises } = this;
    let where = 0;
    for (let node = 0, at = 0; node < vonMises.length; node++) {
      let most = 0;
      for (let face = 0; face < 2; face++) {
        let [sx, sy, txy] = [0, 0, 0];
        for (let k = 0; k < columns; k++) sx += rows[at++] * coordinates[k];
        for (let k = 0; k < columns; k++) sy += rows[at++] * coordinates[k];
        for (let k = 0; k < columns; k++) txy += rows[at++] * coordinates[k];
        most = Math.max(most, 0.5 * (sx * sx + sy * sy + (sx - sy) * (sx - sy)) + 3 * txy * txy);
      }
      vonMises[node] = Math.sqrt(most);
      if (vonMises[node] > vonMises[where]) where = node;
    }
    this.where = where;
    this.largest = vonMises[where];
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
