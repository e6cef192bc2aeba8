// Names over the picture in space, beside what they name; the world's axes, the scale of stress and its largest value.

const CELL_SIZE = 12; // pixels of the map of what is covered
const ANGLES = 16;
const REACH = [20, 32, 46, 62, 80, 100, 124, 150];
const MARGIN = 6;

/** What of the screen is covered, in coarse cells. */
class Cover {
  constructor(width, height) {
    this.columns = Math.ceil(width / CELL_SIZE);
    this.rows = Math.ceil(height / CELL_SIZE);
    this.cells = new Uint8Array(this.columns * this.rows);
  }

  mark(left, top, right, bottom, value) {
    const [c0, c1] = [Math.max(0, Math.floor(left / CELL_SIZE)), Math.min(this.columns - 1, Math.floor(right / CELL_SIZE))];
    const [r0, r1] = [Math.max(0, Math.floor(top / CELL_SIZE)), Math.min(this.rows - 1, Math.floor(bottom / CELL_SIZE))];
    for (let row = r0; row <= r1; row++) for (let column = c0; column <= c1; column++) this.cells[row * this.columns + column] = Math.max(value, this.cells[row * this.columns + column]);
  }

  /** A triangle of the structure, by the cells whose middles are inside it. */
  triangle(a, b, c) {
    const [low, high] = [Math.min, Math.max].map(of => [0, 1].map(axis => of(a[axis], b[axis], c[axis])));
    if (high[0] < 0 || high[1] < 0 || low[0] > this.columns * CELL_SIZE || low[1] > this.rows * CELL_SIZE) return;
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    const first = Math.max(0, Math.floor(low[1] / CELL_SIZE));
    for (let row = first; row <= Math.min(this.rows - 1, high[1] / CELL_SIZE); row++) {
      for (let column = Math.max(0, Math.floor(low[0] / CELL_SIZE)); column <= Math.min(this.columns - 1, high[0] / CELL_SIZE); column++) {
        const [x, y] = [(column + 0.5) * CELL_SIZE, (row + 0.5) * CELL_SIZE];
        const u = ((b[0] - x) * (c[1] - y) - (c[0] - x) * (b[1] - y)) / area;
        const v = ((c[0] - x) * (a[1] - y) - (a[0] - x) * (c[1] - y)) / area;
        if (u >= -0.1 && v >= -0.1 && u + v <= 1.1) this.cells[row * this.columns + column] = 1;
      }
    }
  }

  /** How much of a box is covered: each cell of the structure once, each of a text twenty times. */
  cost(left, top, right, bottom) {
    if (left < 0 || top < 0 || right > this.columns * CELL_SIZE || bottom > this.rows * CELL_SIZE) return 1000;
    let sum = 0;
    for (let row = Math.floor(top / CELL_SIZE); row <= Math.floor(bottom / CELL_SIZE) && row < this.rows; row++) {
      for (let column = Math.floor(left / CELL_SIZE); column <= Math.floor(right / CELL_SIZE) && column < this.columns; column++) {
        const cell = this.cells[row * this.columns + column];
        sum += cell === 2 ? 20 : cell;
      }
    }
    return sum;
  }
}

class Labels {
  constructor(canvas, ramp) {
    this.canvas = canvas;
    this.ramp = ramp;
    this.pen = canvas.getContext("2d");
    this.before = new Map(); // where names stood, beside what they name
  }

  draw(camera, parts, results, options) {
    const { canvas, pen } = this;
    this.theme = options.theme;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.setTransform(options.scale, 0, 0, options.scale, 0, 0);
    pen.font = "12px system-ui, sans-serif";
    pen.textBaseline = "middle";
    pen.lineJoin = "round";
    const [whole, height] = [canvas.width / options.scale, canvas.height / options.scale];
    this.cover = new Cover(whole, height);
    this.cover.mark(0, height - 84, 84, height, 2);
    if (options.stressLimit > 0) this.cover.mark(whole - 110, 0, whole, 0.72 * height, 2);
    for (const part of parts) {
      const [x, width] = [part.x / options.scale, part.width / options.scale];
      if (part.caption) {
        this.text(part.caption, x + 10, 16, "left");
        this.cover.mark(x, 0, x + 20 + pen.measureText(part.caption).width, 28, 2);
      }
      const toClip = camera.toClip(width / height);
      const onScreen = place => this.onScreen(place, toClip, x, width, height);
      for (const { number } of part.shown.slice(0, 1)) {
        const result = results[number];
        if (options.names) this.names(result, part.x, onScreen, x, width);
        if (options.stressLimit > 0) this.largest(result, onScreen);
      }
    }
    this.triad(camera, 40, height - 40);
    if (options.stressLimit > 0) this.scale(options.stressLimit, whole - 96, 34, Math.min(220, 0.5 * height));
  }

  onScreen(place, toClip, x, width, height) {
    const [cx, cy, , cw] = [0, 1, 2, 3].map(row => toClip[row] * place[0] + toClip[4 + row] * place[1] + toClip[8 + row] * place[2] + toClip[12 + row]);
    return cw > 0 ? [x + (0.5 + (0.5 * cx) / cw) * width, (0.5 - (0.5 * cy) / cw) * height] : null;
  }

  /** Names with lines to what they name, where they cover least. */
  names(result, key, onScreen, x, width) {
    for (const body of result.bodies) this.covered(body, onScreen);
    const found = this.places(result).map(([name, place]) => [name, onScreen(place)]).filter(([, at]) => at && at[0] > x && at[0] < x + width);
    for (const [name, at] of found) this.name(name, at, `${key} ${name}`, x, width);
  }

  covered(body, onScreen) {
    const places = new Map();
    const at = node => {
      if (!places.has(node)) places.set(node, onScreen(body.placed(body.bent(node))));
      return places.get(node);
    };
    const { triangles, lines } = body;
    const step = 3 * Math.max(1, Math.floor(triangles.length / 3 / 700)); // neighbours share cells
    for (let k = 0; k + 2 < triangles.length; k += step) {
      const corners = [at(triangles[k]), at(triangles[k + 1]), at(triangles[k + 2])];
      if (corners.every(Boolean)) this.cover.triangle(...corners);
    }
    for (let k = 0; k < lines.length; k += 2) {
      const [a, b] = [at(lines[k]), at(lines[k + 1])];
      if (!a || !b) continue;
      const count = Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) / CELL_SIZE) || 1;
      for (let part = 0; part <= Math.min(count, 200); part++) {
        const [px, py] = [0, 1].map(axis => a[axis] + ((b[axis] - a[axis]) * part) / count);
        this.cover.mark(px, py, px, py, 1);
      }
    }
  }

  /** Names and places: of hinge lines in the middle of their hinges, of bodies in the middle of their nodes. */
  places(result) {
    const lines = new Map();
    for (const { name, point } of result.axes) lines.set(name, [...(lines.get(name) || []), point.here()]);
    const middle = points => times(1 / points.length, points.reduce(plus));
    const found = [...lines].map(([name, points]) => [name, middle(points)]);
    for (const { name, point } of result.dampers) found.push([name, point.here()]);
    for (const body of result.bodies) {
      if (body.triangles.length + body.lines.length === 0) continue;
      const some = [0, 0.25, 0.5, 0.75, 1].map(share => body.placed(body.bent(Math.round(share * (body.count - 1)))));
      found.push([body.name, middle(some)]);
    }
    return found;
  }

  name(name, at, key, x, width) {
    const { pen } = this;
    const shown = name.length > 40 ? `${name.slice(0, 39)}…` : name;
    const half = 0.5 * pen.measureText(shown).width + 3;
    const boxAt = ([dx, dy]) => [at[0] + dx - half, at[1] + dy - 9, at[0] + dx + half, at[1] + dy + 9];
    const cost = offset => {
      const box = boxAt(offset);
      const outside = box[0] < x + MARGIN || box[2] > x + width - MARGIN ? 1000 : 0;
      return outside + this.cover.cost(...box) + 0.02 * Math.hypot(...offset);
    };
    let best = this.before.get(key) || [0, -REACH[0]];
    let least = cost(best) - 0.8; // a name stays where it was unless another place is clearly better
    for (const reach of REACH) {
      for (let k = 0; k < ANGLES; k++) {
        const angle = (2 * Math.PI * k) / ANGLES - Math.PI / 2;
        const offset = [(reach + half) * Math.cos(angle), reach * Math.sin(angle)];
        const now = cost(offset);
        if (now < least) [best, least] = [offset, now];
      }
    }
    this.before.set(key, best);
    const box = boxAt(best);
    this.cover.mark(...box, 2);
    const end = [Math.min(Math.max(at[0], box[0]), box[2]), Math.min(Math.max(at[1], box[1] + 2), box[3] - 2)];
    pen.strokeStyle = this.theme.soft;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(...at);
    pen.lineTo(...end);
    pen.stroke();
    pen.fillStyle = this.theme.soft;
    pen.fillRect(at[0] - 1.5, at[1] - 1.5, 3, 3);
    this.text(shown, at[0] + best[0], at[1] + best[1], "center");
  }

  text(text, x, y, align) {
    const { pen } = this;
    pen.textAlign = align;
    pen.lineWidth = 4;
    pen.strokeStyle = this.theme.paper;
    pen.strokeText(text, x, y);
    pen.fillStyle = this.theme.ink;
    pen.fillText(text, x, y);
  }

  /** A ring where the stress of now is largest, and its value. */
  largest(result, onScreen) {
    const bodies = result.bodies.filter(body => body.stress);
    if (!bodies.length) return;
    const body = bodies.reduce((a, b) => (b.stress.largest > a.stress.largest ? b : a));
    const at = onScreen(body.placed(body.bent(body.stress.where)));
    if (!at) return;
    const { pen } = this;
    for (const [colour, width] of [[this.theme.paper, 4], [css(SECOND), 2]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.beginPath();
      pen.arc(...at, 7, 0, 2 * Math.PI);
      pen.stroke();
    }
    this.name(`${digits(body.stress.largest / 1e6, 3)} MPa`, at, "largest stress", 0, this.canvas.width);
  }

  /** Colours of stress with their values (Pa at the upper end). */
  scale(limit, x, y, height) {
    const { pen, ramp } = this;
    this.text("von Mises,", x, y - 20, "left");
    this.text("larger face", x, y - 6, "left");
    const top = y + 8;
    ramp.forEach((colour, k) => {
      pen.fillStyle = css(colour);
      pen.fillRect(x, top + height * (1 - (k + 1) / ramp.length), 16, height / ramp.length + 1);
    });
    pen.strokeStyle = this.theme.soft;
    pen.lineWidth = 1;
    pen.strokeRect(x, top, 16, height);
    const marks = ticks(0, limit / 1e6, 4);
    for (const value of marks) {
      const at = top + height * (1 - value / (limit / 1e6));
      pen.beginPath();
      pen.moveTo(x + 16, at);
      pen.lineTo(x + 20, at);
      pen.stroke();
      this.text(`${value}${value === marks[marks.length - 1] ? " MPa" : ""}`, x + 23, at, "left");
    }
    pen.fillStyle = "#b8b8b8";
    pen.fillRect(x, top + height + 10, 16, 10);
    this.text("unknown", x + 23, top + height + 15, "left");
  }

  triad(camera, x, y) {
    const { pen } = this;
    const { right, up } = camera.axes();
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, k) => {
      const [dx, dy] = [26 * dot(axis, right), -26 * dot(axis, up)];
      pen.strokeStyle = pen.fillStyle = css(AXIS_COLOURS[k]);
      pen.lineWidth = 2;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + dx, y + dy);
      pen.stroke();
      pen.textAlign = "center";
      if (Math.hypot(dx, dy) > 6) pen.fillText("xyz"[k], x + 1.35 * dx, y + 1.35 * dy);
    });
  }
}
