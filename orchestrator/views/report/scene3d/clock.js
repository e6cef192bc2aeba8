// One time for the picture and all plots: it stands, runs at a speed, or is set.

const WHOLE = 5;
const STILL_STEP = 0.5; // s between pictures where a reader wants little motion

class Clock {
  /** unit: s, or another that is no time, of which the whole takes WHOLE s. */
  constructor(first, last, unit) {
    this.unit = unit;
    this.rate = unit === "s" ? 1 : (last - first) / WHOLE;
    this.first = first;
    this.last = last;
    this.time = first;
    this.speed = 1;
    this.isPlaying = false;
    this.calm = matchMedia("(prefers-reduced-motion: reduce)");
    this.listeners = [];
  }

  written(decimals, time = this.time) {
    return `${time.toFixed(this.unit === "s" ? decimals : Math.min(decimals, 1))} ${this.unit}`;
  }

  /** Be told of every change. */
  listen(act) {
    this.listeners.push(act);
  }

  tell() {
    for (const act of this.listeners) act();
  }

  set(time) {
    this.time = Math.min(Math.max(time, this.first), this.last);
    this.tell();
  }

  toggle() {
    if (this.isPlaying) {
      this.stop();
      return;
    }
    if (this.time >= this.last) this.time = this.first;
    this.isPlaying = true;
    this.before = null;
    requestAnimationFrame(now => this.run(now));
    this.tell();
  }

  stop() {
    this.isPlaying = false;
    this.tell();
  }

  run(now) {
    if (!this.isPlaying) return;
    const gone = this.before === null ? 0 : (now - this.before) / 1000;
    if (this.before === null || !this.calm.matches || gone >= STILL_STEP) {
      this.before = now;
      if (this.time + gone * this.speed * this.rate >= this.last) this.isPlaying = false;
      this.set(this.time + gone * this.speed * this.rate);
    }
    if (this.isPlaying) requestAnimationFrame(later => this.run(later));
  }
}
