// A BVH of boxes in WebAssembly. index.d.ts is the manual.
import base64 from './module.js';

/** The id that stands for "none" in results with a fixed number of ids. */
export const NO_ID = 0xffffffff;

export class HalfspaceError extends Error {
  constructor(argument, reason) {
    super(argument ? `${argument}: ${reason}` : reason);
    this.name = 'HalfspaceError';
    this.argument = argument;
  }
}

function fail(argument, reason) {
  throw new HalfspaceError(argument, reason);
}

// The module --------------------------------------------------------------------------

// What its C library asks a system for: no environment, no files, no exit.
const system = {
  environ_sizes_get(count, bytes) {
    new Uint32Array(memory.buffer)[count >>> 2] = 0;
    new Uint32Array(memory.buffer)[bytes >>> 2] = 0;
    return 0;
  },
  environ_get: () => 0,
};
const NOT_THERE = 52;  // WASI's ENOSYS
const imports = {
  env: new Proxy({}, { get: () => () => {} }),
  wasi_snapshot_preview1: new Proxy(system, {
    get: (known, name) => known[name] ?? (() => NOT_THERE),
  }),
};
const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
const { instance } = await WebAssembly.instantiate(bytes, imports);
const wasm = instance.exports;
const memory = wasm.memory;
wasm._initialize?.();

// Views of the module's memory. It moves as it grows, and views of the old one are empty.
let u8, u32, f32, f64;
function look() {
  if (u8?.length) return;
  u8 = new Uint8Array(memory.buffer);
  u32 = new Uint32Array(memory.buffer);
  f32 = new Float32Array(memory.buffer);
  f64 = new Float64Array(memory.buffer);
}
look();

function text(address) {
  look();
  return new TextDecoder().decode(u8.slice(address, u8.indexOf(0, address)));
}

// The C API's names, as callers know them.
const names = { objects: 'boxes', queries: 'boxes', data: 'bytes', 'hs_bvh_blob()': 'toBytes()' };
const named = (text) => text.replace(/\w+(\(\))?/g, (name) => names[name] ?? name);

function failAsModule(argument = '') {
  fail(named(text(wasm.hs_last_error_argument()).replace(/->.*/, '')) || argument,
    named(text(wasm.hs_last_error_reason())));
}

function check(status, argument) {
  if (status !== 0) failAsModule(argument);
  look();
}

function allocate(bytes) {
  const address = bytes < 2 ** 32 ? wasm.malloc(Math.max(bytes, 8)) >>> 0 : 0;
  if (address === 0) fail('', `out of memory: ${bytes} bytes cannot be allocated`);
  look();
  return address;
}

// Calls run(allocate), and frees what it allocated.
function withMemory(run) {
  const blocks = [];
  try {
    return run((bytes) => {
      blocks.push(allocate(bytes));
      return blocks.at(-1);
    });
  } finally {
    for (const block of blocks) wasm.free(block);
  }
}

// Room for results of one call, kept from call to call.
let room = 0;
let results = 0;
function makeRoom(count) {
  if (room >= count) return;
  const size = Math.max(count, 2 * room, 1024);
  const block = allocate(4 * size);
  if (results) wasm.free(results);
  [results, room] = [block, size];
}

// The results of call(), which writes those for which there is room.
function resultsOf(call, values = 1) {
  for (;;) {
    const total = values * resultOf(call());
    if (total <= room) return idsAt(results, total);
    makeRoom(total);
  }
}

// The numbers of calls of one query, and what a call writes.
const oneValues = allocate(8 * 8);
const oneResult = allocate(8 * 4);

// The number that a call wrote there.
function resultOf(status, argument) {
  check(status, argument);
  return u32[oneResult / 4];
}

const idsAt = (address, count) => u32.slice(address / 4, address / 4 + count);
const floatsAt = (address, count) => f32.slice(address / 4, address / 4 + count);

// Arguments ---------------------------------------------------------------------------

// Rows of `values` numbers, of a Float32Array, a Float64Array or what can become one.
function rowsOf(name, data, values) {
  let array = data;
  if (!(array instanceof Float32Array) && !(array instanceof Float64Array)) {
    if (array === null || typeof array !== 'object' || typeof array.length !== 'number') {
      fail(name, `expected an array of numbers, got ${array === null ? 'null' : typeof array}`);
    }
    array = Float64Array.from(array, (value, i) => {
      if (typeof value !== 'number') fail(`${name}[${i}]`, `expected a number, got ${typeof value}`);
      return value;
    });
  }
  if (array.length === 0) {
    try {
      new Uint8Array(array.buffer);
    } catch {
      fail(name, 'the ArrayBuffer is detached: it was transferred');
    }
  }
  if (array.length % values !== 0) {
    fail(name, `expected ${values} numbers for each, got ${array.length} in all`);
  }
  return array;
}

function boxesOf(name, data, dimensions) {
  const boxes = rowsOf(name, data, 2 * dimensions);
  for (let i = 0; i < boxes.length; i += 2 * dimensions) {
    for (let k = i; k < i + dimensions; ++k) checkBox(name, boxes, k, dimensions);
  }
  return boxes;
}

function checkBox(name, boxes, k, dimensions) {
  if (!(boxes[k] <= boxes[k + dimensions])) {
    fail(`${name}[${k}]`, 'expected a minimum that is not above the maximum, ' +
      `got ${boxes[k]} and ${boxes[k + dimensions]}`);
  }
}

function numbersOf(name, data, values) {
  const numbers = rowsOf(name, data, values);
  const i = numbers.findIndex(Number.isNaN);
  if (i >= 0) fail(`${name}[${i}]`, 'expected a number, got NaN');
  return numbers;
}

function idsOf(ids, count) {
  if (ids === null || typeof ids !== 'object' || typeof ids.length !== 'number') {
    fail('ids', 'expected an array of ids');
  }
  if (count !== undefined && ids.length !== count) {
    fail('ids', `expected as many as boxes, ${count}, got ${ids.length}`);
  }
  return Uint32Array.from(ids, (id, i) => {
    if (!Number.isInteger(id) || id < 0 || id >= NO_ID) {
      fail(`ids[${i}]`, `expected the id of an object, got ${id}`);
    }
    return id;
  });
}

const shown = (value) => (typeof value === 'number' ? value : typeof value);

function countOf(name, value) {
  if (value !== Infinity && !(Number.isInteger(value) && value > 0)) {
    fail(name, `expected a whole number above 0, or Infinity, got ${value}`);
  }
  return value;
}

function distanceOf(name, value) {
  if (!(value >= 0)) fail(name, `expected a number that is not negative, got ${value}`);
  return value;
}

// The numbers of one row. Not numbersOf(), which takes as long as the search for 8 boxes.
function rowOf(name, row, count) {
  if (row?.length !== count) fail(name, `expected ${count} numbers`);
  const numbers = [];
  for (let i = 0; i < count; ++i) {
    const value = row[i];
    if (typeof value !== 'number' || value !== value) {
      fail(`${name}[${i}]`, `expected a number, got ${shown(value)}`);
    }
    numbers.push(value);
  }
  return numbers;
}

// Writes the numbers of a call of one query. After all are read, since a getter can call the
// module.
function write(numbers) {
  look();
  for (let i = 0; i < numbers.length; ++i) f64[oneValues / 8 + i] = numbers[i];
}

// Copies an array to the module, and returns its address.
function copyIn(allocate, array) {
  const address = allocate(array.byteLength);
  new array.constructor(memory.buffer, address, array.length).set(array);
  return address;
}

const isDouble = (array) => (array instanceof Float64Array ? 1 : 0);

// The BVH -----------------------------------------------------------------------------

const registry = new FinalizationRegistry((bvh) => wasm.hs_bvh_destroy(bvh));

// In place of boxes: a BVH of the module, for a new owner.
class Made {
  constructor(dimensions, bvh) {
    this.dimensions = dimensions;
    this.bvh = bvh;
  }
}

export class BVH {
  #bvh;
  #dimensions;

  constructor(boxes, { dimensions = 2, quality = 'high' } = {}) {
    if (dimensions !== 2 && dimensions !== 3) {
      fail('dimensions', `expected 2 or 3, got ${dimensions}`);
    }
    if (quality !== 'high' && quality !== 'fast') {
      fail('quality', `expected "high" or "fast", got ${quality}`);
    }
    const made = boxes instanceof Made ? boxes : withMemory((allocate) => {
      const array = boxesOf('boxes', boxes, dimensions);
      return new Made(dimensions, resultOf(wasm.bvh_create(
        dimensions, isDouble(array), copyIn(allocate, array),
        array.length / (2 * dimensions), quality === 'fast' ? 1 : 0, oneResult)));
    });
    this.#bvh = made.bvh;
    this.#dimensions = made.dimensions;
    registry.register(this, made.bvh, this);
  }

  static fromBytes(bytes) {
    const from = bytes instanceof ArrayBuffer ? new Uint8Array(bytes) : bytes;
    if (!(from instanceof Uint8Array)) {
      fail('bytes', 'expected a Uint8Array or an ArrayBuffer');
    }
    return withMemory((allocate) => {
      const address = copyIn(allocate, from);
      // HS_BOX2 is 1, and HS_BOX3 is 2.
      const dimensions = 1 + resultOf(wasm.hs_blob_kind(address, from.length, oneResult));
      if (dimensions > 3) fail('bytes', 'expected a BVH of boxes, got another kind of bounds');
      return new BVH(new Made(dimensions, resultOf(
        wasm.bvh_from_blob(dimensions, address, from.length, oneResult), 'bytes')));
    });
  }

  dispose() {
    if (!this.#bvh) return;
    registry.unregister(this);
    wasm.hs_bvh_destroy(this.#bvh);
    this.#bvh = 0;
  }

  #open() {
    if (!this.#bvh) fail('', 'the BVH was disposed of');
    return this.#bvh;
  }

  // Calls run(allocate, count, ...) with what functions of the module need of boxes.
  #withBoxes(boxes, run) {
    const bvh = this.#open();
    const array = boxesOf('boxes', boxes, this.#dimensions);
    const count = array.length / (2 * this.#dimensions);
    return withMemory((allocate) => run(allocate, count, bvh, this.#dimensions,
      isDouble(array), copyIn(allocate, array), count));
  }

  get dimensions() { return this.#dimensions; }
  get size() { return resultOf(wasm.hs_bvh_size(this.#open(), oneResult)); }
  get idLimit() { return resultOf(wasm.hs_bvh_id_limit(this.#open(), oneResult)); }

  get bounds() {
    check(wasm.hs_bvh_bounds(this.#open(), oneResult));
    return floatsAt(oneResult, 2 * this.#dimensions);
  }

  toBytes() {
    check(wasm.hs_bvh_blob(this.#open(), oneResult, oneResult + 4));
    const [address, size] = idsAt(oneResult, 2);
    return u8.slice(address, address + size);
  }

  query(box) {
    const bvh = this.#open();
    const dimensions = this.#dimensions;
    const numbers = rowOf('box', box, 2 * dimensions);
    for (let k = 0; k < dimensions; ++k) checkBox('box', numbers, k, dimensions);
    write(numbers);
    return resultsOf(() =>
      wasm.bvh_query(bvh, dimensions, 1, oneValues, 1, results, room, 0, oneResult));
  }

  queryMany(boxes) {
    return this.#withBoxes(boxes, (allocate, count, ...rows) => {
      const offsets = allocate(4 * (count + 1));
      const ids = resultsOf(() =>
        wasm.bvh_query(...rows, results, room, offsets, oneResult));
      return { ids, offsets: idsAt(offsets, count + 1) };
    });
  }

  nearest(point, k = 1, maxDistance = Infinity) {
    const bvh = this.#open();
    const dimensions = this.#dimensions;
    const numbers = rowOf('point', point, dimensions);
    const most = Math.min(countOf('k', k), this.size);
    makeRoom(2 * most);
    write(numbers);
    check(wasm.bvh_nearest(bvh, dimensions, 1, oneValues, 1, most,
      distanceOf('maxDistance', maxDistance), results, results + 4 * most));
    let found = most;
    while (found > 0 && u32[results / 4 + found - 1] === NO_ID) --found;
    return idsAt(results, found);
  }

  nearestMany(points, k = 1, maxDistance = Infinity) {
    const bvh = this.#open();
    const array = numbersOf('points', points, this.#dimensions);
    const count = array.length / this.#dimensions;
    const most = Math.min(countOf('k', k), this.size);
    return withMemory((allocate) => {
      const from = copyIn(allocate, array);
      const ids = allocate(4 * count * most);
      const distances = allocate(4 * count * most);
      check(wasm.bvh_nearest(bvh, this.#dimensions, isDouble(array), from, count, most,
        distanceOf('maxDistance', maxDistance), ids, distances));
      return { k: most, ids: idsAt(ids, count * most), distances: floatsAt(distances, count * most) };
    });
  }

  raycast(origin, direction, maxT = Infinity) {
    const dimensions = this.#dimensions;
    const ray = [...rowOf('origin', origin, dimensions),
      ...rowOf('direction', direction, dimensions), distanceOf('maxT', maxT)];
    const { ids, ts } = this.raycastMany(Float32Array.from(ray));
    return ids[0] === NO_ID ? null : { id: ids[0], t: ts[0] };
  }

  raycastMany(rays) {
    const bvh = this.#open();
    const values = 2 * this.#dimensions + 1;
    const array = Float32Array.from(numbersOf('rays', rays, values));
    const count = array.length / values;
    return withMemory((allocate) => {
      const from = copyIn(allocate, array);
      const ids = allocate(4 * count);
      const ts = allocate(4 * count);
      check(wasm.bvh_raycast(bvh, this.#dimensions, from, count, ids, ts));
      return { ids: idsAt(ids, count), ts: floatsAt(ts, count) };
    });
  }

  pairs(margin = 0) { return this.#pairs(0, margin); }

  join(other, margin = 0) {
    if (!(other instanceof BVH)) fail('other', 'expected a BVH');
    if (other.#dimensions !== this.#dimensions) {
      fail('other', `expected a BVH of ${this.#dimensions} dimensions, got one of ${other.#dimensions}`);
    }
    return this.#pairs(other.#open(), margin);
  }

  #pairs(other, margin) {
    const bvh = this.#open();
    if (distanceOf('margin', margin) === Infinity) fail('margin', 'expected a finite number');
    return resultsOf(() =>
      wasm.bvh_pairs(bvh, other, margin, results, Math.floor(room / 2), oneResult), 2);
  }

  insert(boxes) {
    return this.#withBoxes(boxes, (allocate, count, ...rows) => {
      const ids = allocate(4 * count);
      check(wasm.bvh_insert(...rows, ids));
      return idsAt(ids, count);
    });
  }

  set(ids, boxes) {
    this.#withBoxes(boxes, (allocate, count, ...rows) =>
      check(wasm.bvh_set(...rows, copyIn(allocate, idsOf(ids, count)))));
  }

  erase(ids) {
    const bvh = this.#open();
    const list = idsOf(ids);
    withMemory((allocate) => check(wasm.hs_bvh_erase(bvh, copyIn(allocate, list), list.length)));
  }

  rebuild() { check(wasm.hs_bvh_rebuild(this.#open(), 0)); }
}

if (Symbol.dispose) BVH.prototype[Symbol.dispose] = BVH.prototype.dispose;

/** The version of the library, for example "0.1.0". */
export const version = text(wasm.hs_version());
