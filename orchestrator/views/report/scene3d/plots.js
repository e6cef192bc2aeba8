// Plots over time on canvases: a shared range of time, a cursor, values of recorded rows.

const DASHES = [[], [7, 3], [8, 3, 2, 3], [2, 2], [10, 2], [5, 2, 1, 2, 1, 2], [1, 3]];
const LEFT = 64; // pixels beside the axes, for numbers
const RIGHT = 10;
const TOP = 16;
const BOTTOM = 20;
const HEIGHT = 190;

/** Round places on an axis, about `count` of them. */
const ticks = (low, high, count) => {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(size => size >= rough * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
};

/** A curve: its values at rows of the recorded times. */
class Curve {
  constructor(content, clock, number, result, letter, colour) {
    const rows = content.rows && decoded(content.rows);
    this.result = result;
    this.name = content.label;
    this.call(letter);
    this.values = decoded(content.values);
    this.clock = rows ? Float64Array.from(rows, row => clock[row]) : clock;
    this.tint = colour;
    this.dash = DASHES[(number + 3 * result) % DASHES.length];
    this.width = result ? 1 : 1.5;
  }

  /** letter: of its result, empty of one alone. */
  call(letter) {
    this.letter = letter;
    this.label = `${letter}${this.name}`;
  }

  /** Largest magnitude. */
  largest() {
    return this.values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  }

  /** Lowest and highest value within a range of time, and one row beyond. */
  span(range) {
    let [low, high] = [Infinity, -Infinity];
    const last = Math.min(between(this.clock, range[1]).left + 1, this.clock.length - 1);
    for (let k = between(this.clock, range[0]).left; k <= last; k++) {
      low = Math.min(low, this.values[k]);
      high = Math.max(high, this.values[k]);
    }
    return [low, high];
  }

  /** Draw rows within a range; of many rows in one pixel the ends, the lowest and the highest. */
  draw(pen, range, x, y, theme) {
    pen.strokeStyle = css(theme.shown(this.tint));
    pen.setLineDash(this.dash);
    pen.lineWidth = this.width;
    pen.beginPath();
    const first = between(this.clock, range[0]).left;
    const last = Math.min(between(this.clock, range[1]).left + 1, this.clock.length - 1);
    pen.moveTo(x(this.clock[first]), y(this.values[first]));
    let k = first + 1;
    while (k <= last) {
      const pixel = Math.floor(x(this.clock[k]));
      const start = k;
      let [low, high] = [k, k];
      for (; k <= last && Math.floor(x(this.clock[k])) === pixel; k++) {
        if (this.values[k] < this.values[low]) low = k;
        if (this.values[k] > this.values[high]) high = k;
      }
      const kept = [...new Set([start, low, high, k - 1])].sort((a, b) => a - b);
      for (const row of kept) pen.lineTo(x(this.clock[row]), y(this.values[row]));
    }
    pen.stroke();
    pen.setLineDash([]);
  }
}

const element = (kind, parent, text = "") => {
  const made = document.createElement(kind);
  made.textContent = text;
  parent.append(made);
  return made;
};

/** One plot: a legend that reads values, the curves, and the cursor over them. */
class Plot {
  constructor(title, labelledUnit, curves, plots, isOpen) {
    this.title = title;
    this.unit = labelledUnit;
    this.curves = curves;
    this.plots = plots;
    const largest = Math.max(...curves.map(curve => curve.largest()));
    // five digits of the largest value, as a plot shows no more
    this.decimals = largest > 0 ? Math.min(Math.max(4 - Math.floor(Math.log10(largest)), 0), 12) : 0;
    this.box = element("details", plots.place);
    this.box.className = "plot";
    this.box.open = isOpen;
    element("summary", this.box, title);
    this.at = element("p", this.box);
    this.at.className = "at";
    this.legend();
    const stack = element("div", this.box);
    stack.className = "stack";
    this.under = element("canvas", stack);
    this.over = element("div", stack);
    this.over.className = "over";
    this.over.tabIndex = 0;
    // lines that move are elements, which a browser shifts sooner than it draws a canvas
    this.lines = ["cursor", "pointer"].map(name => {
      const line = element("div", this.over);
      line.className = name;
      return line;
    });
    this.isSeen = true;
    new IntersectionObserver(([entry]) => {
      this.isSeen = entry.isIntersecting;
      this.cursor();
      this.read(plots.readAt());
    }).observe(this.box);
    this.over.setAttribute("role", "img");
    this.over.setAttribute("aria-label", `${title} over time in s; the table above reads values at the cursor`);
    this.box.addEventListener("toggle", () => this.draw());
    plots.controls(this);
  }

  legend() {
    const table = element("table", this.box);
    table.className = "legend";
    this.readings = this.curves.map(curve => {
      const row = element("tr", table);
      const sample = element("canvas", element("td", row));
      [sample.width, sample.height] = [56, 16];
      sample.setAttribute("aria-hidden", "true");
      const pen = sample.getContext("2d");
      pen.strokeStyle = css(this.plots.theme.shown(curve.tint));
      pen.lineWidth = 2 * curve.width;
      pen.setLineDash(curve.dash.map(part => 2 * part));
      pen.beginPath();
      pen.moveTo(0, 8);
      pen.lineTo(56, 8);
      pen.stroke();
      element("td", row, curve.label);
      const value = element("td", row);
      value.className = "n";
      element("td", row, this.unit);
      return value;
    });
  }

  /** Whether nobody reads it now: it is folded, or out of sight while time runs. */
  rests() {
    return !this.box.open || (this.plots.clock.isPlaying && !this.isSeen);
  }

  /** Values at the recorded row nearest to a time. */
  read(time) {
    if (this.rests()) return;
    const rows = new Map();
    this.curves.forEach((curve, k) => {
      const row = nearest(curve.clock, time);
      const size = Number(curve.values[row].toFixed(this.decimals)) + 0; // no minus of a zero
      this.readings[k].textContent = size.toFixed(this.decimals);
      if (!rows.has(curve.letter)) rows.set(curve.letter, `${curve.letter}${this.plots.clock.written(6, curve.clock[row])}`);
    });
    this.at.textContent = `Recorded values at ${[...rows.values()].join(", ")}`;
  }

  resize() {
    const scale = Math.min(devicePixelRatio || 1, 2);
    this.width = Math.max(this.under.parentElement.clientWidth, 200);
    this.under.width = Math.round(this.width * scale);
    this.under.height = Math.round(HEIGHT * scale);
    this.under.getContext("2d").setTransform(scale, 0, 0, scale, 0, 0);
  }

  x(time) {
    const [first, last] = this.plots.range;
    return LEFT + ((time - first) / (last - first)) * (this.width - LEFT - RIGHT);
  }

  /** The time at a place across the plot, pixels. */
  timeAt(x) {
    const [first, last] = this.plots.range;
    return first + ((x - LEFT) / (this.width - LEFT - RIGHT)) * (last - first);
  }

  draw() {
    if (!this.box.open) return;
    this.resize();
    const pen = this.under.getContext("2d");
    pen.clearRect(0, 0, this.width, HEIGHT);
    const spans = this.curves.map(curve => curve.span(this.plots.range));
    let [low, high] = [Math.min(...spans.map(s => s[0])), Math.max(...spans.map(s => s[1]))];
    const margin = 0.06 * (high - low) || 0.5 * Math.abs(high) || 1;
    [low, high] = [low - margin, high + margin];
    const y = value => TOP + ((high - value) / (high - low)) * (HEIGHT - TOP - BOTTOM);
    this.axes(pen, low, high, y);
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, TOP, this.width - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
    pen.clip();
    for (const curve of this.curves) curve.draw(pen, this.plots.range, time => this.x(time), y, this.plots.theme);
    pen.restore();
    this.events(pen);
    this.cursor();
    this.read(this.plots.readAt());
  }

  axes(pen, low, high, y) {
    const right = this.width - RIGHT;
    pen.font = "11px system-ui, sans-serif";
    const { soft, faint } = this.plots.theme.now;
    pen.fillStyle = soft;
    pen.strokeStyle = faint;
    pen.lineWidth = 1;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (const value of ticks(low, high, 5)) {
      pen.strokeRect(LEFT, y(value), right - LEFT, 0);
      pen.fillText(written(value), LEFT - 5, y(value));
    }
    pen.textAlign = "center";
    const places = ticks(...this.plots.range, Math.max(2, Math.floor(this.width / 110)));
    places.forEach((time, k) => {
      pen.strokeRect(this.x(time), TOP, 0, HEIGHT - TOP - BOTTOM);
      pen.fillText(k === places.length - 1 ? `${written(time)} ${this.plots.clock.unit}` : written(time), Math.min(this.x(time), right - 14), HEIGHT - 8);
    });
    pen.textAlign = "left";
    pen.fillText(this.unit, 2, TOP - 6);
    pen.strokeStyle = soft;
    pen.strokeRect(LEFT, TOP, right - LEFT, HEIGHT - TOP - BOTTOM);
  }

  /** Instants of events as dotted lines, with their names above where there is room. */
  events(pen) {
    let free = LEFT;
    pen.strokeStyle = pen.fillStyle = this.plots.theme.now.soft;
    pen.lineWidth = 1;
    pen.textBaseline = "alphabetic";
    pen.textAlign = "left";
    for (const event of this.plots.events) {
      const x = this.x(event.time);
      if (x < LEFT || x > this.width - RIGHT) continue;
      pen.setLineDash([2, 3]);
      pen.beginPath();
      pen.moveTo(x, TOP);
      pen.lineTo(x, HEIGHT - BOTTOM);
      pen.stroke();
      const width = pen.measureText(event.text).width;
      const left = Math.min(Math.max(x - width / 2, LEFT), this.width - width);
      if (left < free) continue;
      pen.fillText(event.text, left, TOP - 4);
      free = left + width + 8;
    }
    pen.setLineDash([]);
  }

  /** The time of the picture, and of the place that is pointed at. */
  cursor() {
    if (this.rests() || !this.width) return;
    [this.plots.clock.time, this.plots.hovered].forEach((time, k) => {
      const x = time === null ? -1 : this.x(time);
      this.lines[k].hidden = x < LEFT - 1 || x > this.width - RIGHT + 1;
      this.lines[k].style.transform = `translateX(${x.toFixed(1)}px)`;
    });
  }
}

/** All plots, with one range of time. */
class Plots {
  constructor(place, content, clock, theme) {
    this.place = place;
    this.theme = theme;
    const { colours } = content;
    this.clock = clock;
    this.whole = [clock.first, clock.last > clock.first ? clock.last : clock.first + 1]; // a run of one row has no range
    this.range = [...this.whole];
    this.hovered = null;
    this.results = content.results;
    const clocks = content.results.map(result => decoded(result.clock));
    this.list = this.titles(content).map(([title, unitName], k) => {
      const curves = content.results.flatMap((result, number) => {
        const panel = result.plots.find(one => one.title === title);
        const letter = content.results.length > 1 ? `${result.letter}: ` : "";
        return panel ? panel.curves.map((curve, n) => new Curve(curve, clocks[number], n, number, letter, colours[n % colours.length])) : [];
      });
      return new Plot(title, unitName, curves, this, k < 4);
    });
    clock.listen(() => this.follow());
    theme.listen(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(place);
  }

  /** Titles and units of the plots of all results, each once. */
  titles(content) {
    return [...new Map(content.results.flatMap(result => result.plots.map(panel => [panel.title, panel.unit])))];
  }

  get events() {
    return this.results.flatMap(result => result.events).sort((a, b) => a.time - b.time);
  }

  readAt() {
    return this.hovered === null ? this.clock.time : this.hovered;
  }

  /** Give one of two results another name. */
  call(number, letter) {
    this.results[number].letter = letter;
    for (const plot of this.list) {
      plot.curves.forEach((curve, k) => {
        if (curve.result !== number) return;
        curve.call(`${letter}: `);
        plot.readings[k].previousElementSibling.textContent = curve.label;
      });
    }
    this.follow();
  }

  follow() {
    for (const plot of this.list) {
      plot.cursor();
      plot.read(this.readAt());
    }
  }

  draw() {
    for (const plot of this.list) plot.draw();
  }

  /** Show another range of time, within the run. */
  show(first, last) {
    const [low, high] = this.whole;
    const size = Math.min(Math.max(last - first, 1e-5 * (high - low)), high - low);
    const start = Math.min(Math.max(first, low), high - size);
    this.range = [start, start + size];
    this.draw();
  }

  /** Zoom about a time. */
  zoom(factor, time) {
    const [first, last] = this.range;
    const fixed = Math.min(Math.max(time, first), last);
    this.show(fixed - factor * (fixed - first), fixed + factor * (last - fixed));
  }

  pan(share) {
    const shift = share * (this.range[1] - this.range[0]);
    this.show(this.range[0] + shift, this.range[1] + shift);
  }

  controls(plot) {
    const canvas = plot.over;
    let start = null;
    canvas.addEventListener("pointerdown", event => {
      canvas.setPointerCapture(event.pointerId);
      start = event.shiftKey ? { x: event.offsetX, range: [...this.range] } : { x: null };
      if (start.x === null) this.clock.set(plot.timeAt(event.offsetX));
    });
    canvas.addEventListener("pointermove", event => {
      this.hovered = Math.min(Math.max(plot.timeAt(event.offsetX), this.range[0]), this.range[1]);
      if (start && start.x === null) this.clock.set(this.hovered);
      else if (start) {
        const shift = ((start.x - event.offsetX) / (plot.width - LEFT - RIGHT)) * (start.range[1] - start.range[0]);
        this.show(start.range[0] + shift, start.range[1] + shift);
      }
      this.follow();
    });
    canvas.addEventListener("pointerup", () => { start = null; });
    canvas.addEventListener("pointercancel", () => { start = null; });
    canvas.addEventListener("pointerleave", () => {
      this.hovered = null;
      this.follow();
    });
    canvas.addEventListener("dblclick", () => this.show(...this.whole));
    canvas.addEventListener("wheel", event => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      this.zoom(Math.exp(0.002 * event.deltaY), plot.timeAt(event.offsetX));
    }, { passive: false });
    canvas.addEventListener("keydown", event => this.key(event, plot));
  }

  key(event, plot) {
    const curve = plot.curves[0];
    const step = rows => {
      let row = nearest(curve.clock, this.clock.time);
      const last = curve.clock.length - 1;
      if (rows > 0) while (row < last && curve.clock[row + 1] === curve.clock[row]) row += 1; // events have two rows
      this.clock.set(curve.clock[Math.min(Math.max(row + rows, 0), last)]);
    };
    const keys = {
      ArrowLeft: () => (event.shiftKey ? this.pan(-0.1) : step(-1)),
      ArrowRight: () => (event.shiftKey ? this.pan(0.1) : step(1)),
      PageUp: () => step(-25),
      PageDown: () => step(25),
      Home: () => this.clock.set(this.clock.first),
      End: () => this.clock.set(this.clock.last),
      "+": () => this.zoom(0.7, this.clock.time),
      "-": () => this.zoom(1 / 0.7, this.clock.time),
      0: () => this.show(...this.whole),
      " ": () => this.clock.toggle(),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  }
}
