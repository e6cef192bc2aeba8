// Numbers of the page: base64 of little-endian arrays, see numbers.py.

const KINDS = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, i16: Int16Array };

/** Values of a block; whole numbers that stand for others become those, by the scale of their column. */
const decoded = block => {
  const text = atob(block.data);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  const stored = new KINDS[block.kind](bytes.buffer);
  if (!block.scale) return stored;
  const columns = block.scale.length;
  const values = new Float32Array(stored.length);
  for (let k = 0; k < stored.length; k++) values[k] = stored[k] * block.scale[k % columns];
  return values;
};

/** The last row at or before a time on a rising clock, and the share of the way to the next. */
const between = (clock, time) => {
  let low = 0;
  let high = clock.length - 1;
  if (time <= clock[0]) return { left: 0, share: 0 };
  if (time >= clock[high]) return { left: high, share: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (clock[middle] <= time) low = middle;
    else high = middle;
  }
  return { left: low, share: (time - clock[low]) / (clock[high] - clock[low]) };
};

/** Row of a rising clock nearest to a time; of several at one instant the first, which is before the event. */
const nearest = (clock, time) => {
  const { left, share } = between(clock, time);
  let row = share > 0.5 ? left + 1 : left;
  while (row > 0 && clock[row - 1] === clock[row]) row -= 1;
  return row;
};

/** Values (rows of `size` numbers) at a place between two rows, in a straight line. */
const interpolated = (values, size, { left, share }, out) => {
  const first = left * size;
  const step = share > 0 ? size : 0;
  for (let k = 0; k < size; k++) {
    out[k] = values[first + k] + share * (values[first + step + k] - values[first + k]);
  }
  return out;
};

/** A number with so many digits, without trailing zeros. */
const digits = (value, count) => String(Number(value.toPrecision(count)));

/** A number in six digits, without an exponent where it needs none. */
const written = value => {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(5);
  return String(Number(value.toPrecision(6)));
};
