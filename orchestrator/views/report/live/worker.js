// The wing as one FMU (FMI 2.0) in WebAssembly, in a thread of its own: it runs from given data and returns all rows.

const FILE = 4;
const BAD_FILE = 8;
const CO_SIMULATION = 1;
const WARNING = 1;

/** What the C library needs of a system (WASI preview 1): a folder "/" with one file to read, and a clock. */
const system = bytes => {
  let place = 0;
  let memory = null;
  const view = () => new DataView(memory.buffer);
  const calls = {
    fd_prestat_get: (file, at) => {
      if (file !== 3) return BAD_FILE;
      view().setUint8(at, 0);
      view().setUint32(at + 4, 1, true);
      return 0;
    },
    fd_prestat_dir_name: (file, at) => {
      view().setUint8(at, "/".charCodeAt(0));
      return 0;
    },
    fd_fdstat_get: (file, at) => {
      const REGULAR = 4;
      const FOLDER = 3;
      view().setUint8(at, file === 3 ? FOLDER : REGULAR);
      view().setUint16(at + 2, 0, true);
      view().setBigUint64(at + 8, ~0n, true);
      view().setBigUint64(at + 16, ~0n, true);
      return 0;
    },
    fd_fdstat_set_flags: () => 0,
    path_open: (folder, flags, path, length, more, rights, inherited, fileFlags, at) => {
      place = 0;
      view().setInt32(at, FILE, true);
      return 0;
    },
    fd_seek: (file, offset, from, at) => {
      place = Number(offset) + [0, place, bytes.length][from];
      view().setBigUint64(at, BigInt(place), true);
      return 0;
    },
    fd_read: (file, parts, count, at) => {
      let read = 0;
      for (let k = 0; k < count; k++) {
        const to = view().getUint32(parts + 8 * k, true);
        const part = bytes.subarray(place, place + view().getUint32(parts + 8 * k + 4, true));
        new Uint8Array(memory.buffer).set(part, to);
        place += part.length;
        read += part.length;
      }
      view().setUint32(at, read, true);
      return 0;
    },
    fd_write: (file, parts, count, at) => {
      view().setUint32(at, 0, true);
      return BAD_FILE;
    },
    fd_close: () => 0,
    clock_time_get: (clock, precision, at) => {
      view().setBigUint64(at, BigInt(Math.round(1e6 * performance.now())), true);
      return 0;
    },
    proc_exit: () => { throw new Error("the library has stopped"); },
  };
  return { calls, use: found => { memory = found; } };
};

/** All rows of a run: `width` values from the reference `first` on, at `points` + 1 times; told: hears of the progress. */
const run = async (module, { bytes, token, first, width, until, points }, told) => {
  const { calls, use } = system(bytes);
  const library = (await WebAssembly.instantiate(module, { wasi_snapshot_preview1: calls })).exports;
  use(library.memory);
  library._initialize();
  const put = content => {
    const at = library.malloc(content.length);
    new Uint8Array(library.memory.buffer).set(content, at);
    return at;
  };
  const text = words => put(new TextEncoder().encode(`${words}\0`));
  const callbacks = put(new Uint8Array(20)); // functions of the host are optional, of which these are none
  const fmu = library.fmi2Instantiate(text("wing"), CO_SIMULATION, text(token), text("file:///"), callbacks, 0, 0);
  if (!fmu) throw new Error("these values make no wing: the model refuses them");
  const done = (name, time, ...values) => {
    if (library[name](fmu, ...values) > WARNING) throw new Error(`the run cannot go on at ${time.toFixed(3)} s with these values`);
  };
  done("fanfoldAcceptNumbers", 0);
  done("fmi2SetupExperiment", 0, 0, 0, 0, 0, 0);
  done("fmi2EnterInitializationMode", 0);
  done("fmi2ExitInitializationMode", 0);
  const references = put(new Uint8Array(Uint32Array.from({ length: width }, (_, k) => first + k).buffer));
  const found = library.malloc(8 * width);
  const rows = new Float64Array((points + 1) * width);
  const h = until / points;
  for (let row = 0; row <= points; row++) {
    if (row) done("fmi2DoStep", row * h, (row - 1) * h, h, 1);
    done("fmi2GetReal", row * h, references, width, found);
    rows.set(new Float64Array(library.memory.buffer, found, width), row * width);
    if (row % 20 === 0) told(row / points);
  }
  return rows;
};

let compiled = null;

onmessage = async ({ data }) => {
  try {
    if (data.library) {
      compiled = WebAssembly.compile(data.library);
      return;
    }
    const began = performance.now();
    const rows = await run(await compiled, data, share => postMessage({ number: data.number, share }));
    postMessage({ number: data.number, rows, seconds: (performance.now() - began) / 1e3 }, [rows.buffer]);
  } catch (error) {
    postMessage({ number: data.number, error: error.message });
  }
};
