// A BVH of boxes and a triangle mesh in WebAssembly. index.d.ts is the manual. index.js and init.js start it.
export const NO_ID = 0xffffffff;

export class HalfspaceError extends Error {
  constructor(argument, reason) {
    super(argument ? `${argument}: ${reason}` : reason);
    this.name = 'HalfspaceError';
    this.argument = argument;
  }
}

function expect(isSo, argument, what, value) {
  if (isSo) return;
  const isShown = value === null || ['number', 'string'].includes(typeof value);
  throw new HalfspaceError(argument, `expected ${what}, got ${isShown ? value : typeof value}`);
}

// The module --------------------------------------------------------------------------

// There is no system: no environment, no files, no exit. 52 is WASI's ENOSYS.
const absent = (result) => new Proxy({}, { get: () => () => result });
export const imports = { env: absent(), wasi_snapshot_preview1: absent(52) };

let wasm, memory;
export let version;

// The first instance is that of all objects.
export function start(instance) {
  if (wasm) return;
  wasm = instance.exports;
  memory = wasm.memory;
  wasm._initialize?.();
  oneValues = allocate(8 * 8);
  oneRow = [0, 1].map((isDouble) => Array.from({ length: 8 }, (_, n) =>
    wasm.rows(8 * isDouble + n, isDouble, oneValues, 1, n)));
  oneResult = allocate(8 * 4);
  spheres = wasm.sphere_options();
  version = text(wasm.hs_version());
}

// Views of the module's memory. It moves as it grows, and views of the old one are empty.
let u8, u32, f32, f64;
function look() {
  if (u8?.length) return;
  [u8, u32, f32, f64] = [Uint8Array, Uint32Array, Float32Array, Float64Array]
    .map((View) => new View(memory.buffer));
}

// The text at an address, with the names that callers know.
const names = {
  objects: 'boxes', queries: 'boxes', data: 'bytes', max_distance: 'maxDistance',
  'options->margin': 'margin', 'hs_bvh_blob()': 'toBytes()', indices: 'faces',
};
const text = (address) => new TextDecoder().decode(u8.slice(address, u8.indexOf(0, address)))
  .replace(/\w+(->margin|\(\))?/g, (name) => names[name] ?? name);

function check(status, argument = '') {
  look();
  if (status === 0) return;
  const named = text(wasm.hs_last_error_argument()).replace(/->.*/, '');
  throw new HalfspaceError(named || argument, text(wasm.hs_last_error_reason()));
}

function allocate(bytes) {
  const address = bytes < 2 ** 32 ? wasm.malloc(Math.max(bytes, 8)) >>> 0 : 0;
  if (address === 0) {
    throw new HalfspaceError('', `out of memory: ${bytes} bytes cannot be allocated`);
  }
  look();
  return address;
}

// Calls run(allocate), and frees what it allocated.
function withMemory(run) {
  if (!wasm) throw new HalfspaceError('', 'expected that init() has ended: await it first');
  const blocks = [];
  try {
    return run((bytes) => blocks[blocks.push(allocate(bytes)) - 1]);
  } finally {
    for (const block of blocks) wasm.free(block);
  }
}

// Room for results of one call, kept from call to call. Returns whether there was too little.
let [results, room] = [0, 0];
function makeRoom(count) {
  if (room >= count) return false;
  const size = Math.max(count, 2 * room, 1024);
  const block = allocate(4 * size);
  wasm.free(results);
  [results, room] = [block, size];
  return true;
}

// The numbers of calls of one query, the rows of so many floats or doubles that they are, and
// what a call writes. Rows are in slots of module.c, and no row has 0 or 1 numbers.
let oneValues, oneRow, oneResult;

// The options of a query of spheres.
let spheres;

// Writes the numbers of a call of one query, and returns its row. After all are read, since
// a getter can call the module.
function write(numbers, isDouble = 1) {
  look();
  const [values, first] = isDouble ? [f64, oneValues / 8] : [f32, oneValues / 4];
  for (let i = 0; i < numbers.length; ++i) values[first + i] = numbers[i];
  return oneRow[isDouble][numbers.length];
}

// The number that a call wrote there.
function resultOf(status, argument) {
  check(status, argument);
  return u32[oneResult / 4];
}

// slice() of no elements takes ten times as long, and that of few a half more.
const none = new Uint32Array(0);
function idsAt(address, count) {
  const first = address / 4;
  if (count === 0) return new Uint32Array(none);
  if (count > 16) return u32.slice(first, first + count);
  const ids = new Uint32Array(count);
  for (let i = 0; i < count; ++i) ids[i] = u32[first + i];
  return ids;
}

const floatsAt = (address, count) => f32.slice(address / 4, address / 4 + count);

// Copies an array of viewOf() to the module, and returns its address.
function copyIn(allocate, array) {
  const address = allocate(array.byteLength);
  new array.constructor(memory.buffer, address, array.length).set(array);
  return address;
}

// Calls run(rows, count, allocate) with the rows of an array, which are in the module then. The
// slot of arrays is 0.
const withRows = (array, values, run) => withMemory((allocate) => {
  const count = array.length / values;
  return run(wasm.rows(0, array instanceof Float64Array ? 1 : 0, copyIn(allocate, array), count,
    values), count, allocate);
});

// Returns what call(rows, ...addresses) writes: `most` ids of each row, and so many numbers of
// each row as `numbers` says.
function answers(array, values, [most, ...numbers], call) {
  return withRows(array, values, (rows, count, allocate) => {
    const ids = allocate(4 * most * count);
    const to = numbers.map((width) => allocate(4 * width * count));
    check(call(rows, ids, ...to));
    return [idsAt(ids, most * count), ...to.map((at, i) => floatsAt(at, numbers[i] * count))];
  });
}

// Arguments ---------------------------------------------------------------------------

const typedArray = Object.getPrototypeOf(Uint8Array.prototype);
const tagOf = Object.getOwnPropertyDescriptor(typedArray, Symbol.toStringTag).get;

// Returns what run() makes of the memory of an argument.
function withBuffer(name, run) {
  try {
    return run();
  } catch {
    throw new HalfspaceError(name, 'the ArrayBuffer is detached, or shorter than the array');
  }
}

// The memory of a typed array as a View, or null if it is another array. Its own class can be
// one of another realm, or have another constructor.
const viewOf = (View, name, data) => (tagOf.call(data) !== View.name ? null
  : withBuffer(name, () => {
    typedArray.keys.call(data);
    return new View(data.buffer, data.byteOffset, data.length);
  }));

// The values of any array as a View, each checked by valueOf(name, i, value). from() takes
// seven times as long.
function copyOf(View, name, data, what, valueOf) {
  const length = typeof data === 'object' ? data?.length : undefined;
  expect(typeof length === 'number' && length >= 0, name, `an array of ${what}`, data);
  const array = new View(length);
  for (let i = 0; i < array.length; ++i) array[i] = valueOf(name, i, data[i]);
  return array;
}

const numberOf = (name, i, value) => (typeof value === 'number' && value === value ? value
  : expect(false, `${name}[${i}]`, 'a number', value));

// Rows of `values` numbers, of a Float32Array, a Float64Array or what can become one.
function rowsOf(name, data, values) {
  const array = viewOf(Float32Array, name, data) ?? viewOf(Float64Array, name, data)
    ?? copyOf(Float64Array, name, data, 'numbers', numberOf);
  expect(array.length % values === 0, name, `${values} numbers for each`, array.length);
  return array;
}

// The same without NaN, which C accepts.
function numbersOf(name, data, values) {
  const numbers = rowsOf(name, data, values);
  for (let i = 0; i < numbers.length; ++i) numberOf(name, i, numbers[i]);
  return numbers;
}

function floatsOf(name, data, values) {
  const numbers = numbersOf(name, data, values);
  return numbers instanceof Float32Array ? numbers : new Float32Array(numbers);
}

// The numbers of one row. Not numbersOf(), which takes as long as the search for 8 boxes.
function rowOf(name, row, count) {
  if (row?.length !== count) throw new HalfspaceError(name, `expected ${count} numbers`);
  // push() takes longer.
  const numbers = count === 2 ? [row[0], row[1]] : count === 3 ? [row[0], row[1], row[2]]
    : count === 4 ? [row[0], row[1], row[2], row[3]]
      : [row[0], row[1], row[2], row[3], row[4], row[5]];
  for (let i = 0; i < count; ++i) numberOf(name, i, numbers[i]);
  return numbers;
}

// Boxes, whose minima are not above their maxima.
function checkBoxes(name, boxes, dimensions) {
  for (let i = 0; i < boxes.length; i += 2 * dimensions) {
    for (let k = i; k < i + dimensions; ++k) {
      if (boxes[k] <= boxes[k + dimensions]) continue;
      expect(false, `${name}[${k}]`, 'a minimum that is not above the maximum',
        `${boxes[k]} and ${boxes[k + dimensions]}`);
    }
  }
  return boxes;
}

const boxesOf = (data, dimensions) =>
  checkBoxes('boxes', rowsOf('boxes', data, 2 * dimensions), dimensions);

const idsOf = (ids, name = 'ids', what = 'the id of an object') =>
  viewOf(Uint32Array, name, ids) ?? copyOf(Uint32Array, name, ids, name, (_, i, id) =>
    (typeof id === 'number' && id >>> 0 === id ? id
      : expect(false, `${name}[${i}]`, what, id)));

// The BVH -----------------------------------------------------------------------------

const registry = new FinalizationRegistry((bvh) => wasm.hs_bvh_destroy(bvh));

// The option that is a BVH of the module, in place of boxes.
const made = Symbol('made');

export class BVH {
  #bvh;
  #dimensions;

  constructor(boxes, { dimensions = 2, quality = 'high', queryExtents, [made]: bvh } = {}) {
    expect(dimensions === 2 || dimensions === 3, 'dimensions', '2 or 3', dimensions);
    expect(quality === 'high' || quality === 'fast', 'quality', '"high" or "fast"', quality);
    const extents = queryExtents === undefined ? undefined
      : floatsOf('queryExtents', rowOf('queryExtents', queryExtents, dimensions), dimensions);
    expect(!extents?.some((extent) => extent < 0), 'queryExtents',
      'numbers that are not negative', queryExtents);
    this.#dimensions = dimensions;
    this.#bvh = bvh ?? withRows(boxesOf(boxes, dimensions), 2 * dimensions, (rows, _, allocate) =>
      resultOf(wasm.hs_bvh_create(wasm.config(dimensions, quality === 'fast' ? 1 : 0,
        extents ? copyIn(allocate, extents) : 0), rows, oneResult)));
    registry.register(this, this.#bvh, this);
  }

  static fromBytes(bytes) {
    const isBuffer = Object.prototype.toString.call(bytes) === '[object ArrayBuffer]';
    const from = isBuffer ? withBuffer('bytes', () => new Uint8Array(bytes))
      : viewOf(Uint8Array, 'bytes', bytes);
    expect(from, 'bytes', 'a Uint8Array or an ArrayBuffer', bytes);
    return withMemory((allocate) => {
      const address = copyIn(allocate, from);
      // HS_BOX2 is 1, and HS_BOX3 is 2.
      const dimensions = 1 + resultOf(wasm.hs_blob_kind(address, from.length, oneResult));
      expect(dimensions <= 3, 'bytes', 'a BVH of boxes', 'another kind of bounds');
      const config = wasm.config(dimensions, 0, 0);
      const bvh = resultOf(
        wasm.hs_bvh_from_blob(config, address, from.length, oneResult), 'bytes');
      return new BVH([], { dimensions, [made]: bvh });
    });
  }

  dispose() {
    if (!this.#bvh) return;
    registry.unregister(this);
    wasm.hs_bvh_destroy(this.#bvh);
    this.#bvh = 0;
  }

  // After all arguments are read, since a getter can dispose of it.
  #open() {
    if (!this.#bvh) throw new HalfspaceError('', 'the BVH was disposed of');
    return this.#bvh;
  }

  #withBoxes(boxes, run) {
    const array = boxesOf(boxes, this.#dimensions);
    this.#open();
    return withRows(array, 2 * this.#dimensions, run);
  }

  #answers(array, values, widths, call) {
    this.#open();
    return answers(array, values, widths, call);
  }

  // Returns the ids that the queries find. The options name their shape.
  #found(rows, options, offsets = 0, queries = 0) {
    const bvh = this.#open();
    let total;
    do {
      total = resultOf(wasm.hs_bvh_query(bvh, rows, options, results, room, offsets, oneResult));
      for (let i = offsets / 4; i < offsets / 4 + queries; ++i) {
        // The sums of 32 bits are too small.
        if (u32[i] > u32[i + 1]) throw new HalfspaceError('', 'out of memory: too many results');
      }
    } while (makeRoom(total));
    return idsAt(results, total);
  }

  // The pairs of this BVH, or those with another.
  #pairs(other, margin) {
    const apart = Number(margin);
    const trees = [this.#open(), other?.#open() ?? 0];
    let total;
    do {
      total = 2 * resultOf(wasm.find_pairs(...trees, apart, results, room >>> 1, oneResult));
    } while (makeRoom(total));
    return idsAt(results, total);
  }

  #most(k) {
    expect(k === Infinity || (Number.isInteger(k) && k > 0), 'k',
      'a whole number above 0, or Infinity', k);
    return Math.min(k, this.size);
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
    return size > 0 ? u8.slice(address, address + size) : this.#emptyBytes();
  }

  // A BVH that never had a box has no bytes, which would not have its dimensions.
  #emptyBytes() {
    const tree = new BVH(new Float32Array(2 * this.#dimensions), { dimensions: this.#dimensions });
    tree.erase([0]);
    const bytes = tree.toBytes();
    tree.dispose();
    return bytes;
  }

  query(box) {
    const dimensions = this.#dimensions;
    return this.#found(
      write(checkBoxes('box', rowOf('box', box, 2 * dimensions), dimensions)), 0);
  }

  queryMany(boxes) {
    return this.#withBoxes(boxes, (rows, count, allocate) => {
      const offsets = allocate(4 * (count + 1));
      const ids = this.#found(rows, 0, offsets, count);
      return { ids, offsets: idsAt(offsets, count + 1) };
    });
  }

  within(point, radius) {
    const sphere = rowOf('point', point, this.#dimensions);
    let enclosing = Number(radius);
    expect(enclosing >= 0, 'radius', 'a number that is not negative', radius);
    // The sphere of floats encloses that of doubles.
    for (const value of sphere) enclosing += 1.000001 * Math.abs(value - Math.fround(value)) || 0;
    sphere.push(enclosing * (1 + 2 ** -23));
    return this.#found(write(sphere, 0), spheres);
  }

  nearest(point, k = 1, maxDistance = Infinity, allTies = false) {
    const numbers = rowOf('point', point, this.#dimensions);
    const limit = Number(maxDistance);
    const most = this.#most(k);
    // All ties are found when one more box is farther than they.
    for (let size = allTies ? most + 1 : most; ; size = Math.min(8 * size, this.size + 1)) {
      makeRoom(2 * size);
      const distances = results + 4 * size;
      check(wasm.hs_bvh_nearest_to_points(this.#bvh, write(numbers), size, limit, 0, results,
        distances));
      const last = f32[distances / 4 + most - 1];
      let found = size;
      while (found > 0 && (u32[results / 4 + found - 1] === NO_ID ||
        f32[distances / 4 + found - 1] > last)) --found;
      // Altered bytes can have more boxes than their header says.
      if (found < size || !allTies || size > this.size) return idsAt(results, found);
    }
  }

  nearestMany(points, k = 1, maxDistance = Infinity) {
    const array = numbersOf('points', points, this.#dimensions);
    const limit = Number(maxDistance);
    const most = this.#most(k);
    const [ids, distances] = this.#answers(array, this.#dimensions, [most, most],
      (rows, ...to) =>
        wasm.hs_bvh_nearest_to_points(this.#bvh, rows, most, limit, 0, ...to));
    return { k: most, ids, distances };
  }

  raycast(origin, direction, maxT = Infinity) {
    const ray = [...rowOf('origin', origin, this.#dimensions),
      ...rowOf('direction', direction, this.#dimensions), Number(maxT)];
    expect(ray.at(-1) >= 0, 'maxT', 'a number that is not negative', maxT);
    const id = resultOf(wasm.hs_bvh_raycast(this.#open(), write(ray, 0), 0, 0, oneResult,
      oneResult + 4));
    return id === NO_ID ? null : { id, t: f32[oneResult / 4 + 1] };
  }

  raycastMany(rays) {
    const values = 2 * this.#dimensions + 1;
    const [ids, ts] = this.#answers(floatsOf('rays', rays, values), values, [1, 1],
      (rows, ...to) => wasm.hs_bvh_raycast(this.#bvh, rows, 0, 0, ...to));
    return { ids, ts };
  }

  pairs(margin = 0) { return this.#pairs(null, margin); }

  join(other, margin = 0) {
    expect(other instanceof BVH, 'other', 'a BVH', other);
    expect(other.#dimensions === this.#dimensions, 'other',
      `a BVH of ${this.#dimensions} dimensions`, other.#dimensions);
    return this.#pairs(other, margin);
  }

  insert(boxes) {
    return this.#withBoxes(boxes, (rows, count, allocate) => {
      const ids = allocate(4 * count);
      check(wasm.hs_bvh_insert(this.#bvh, rows, ids));
      return idsAt(ids, count);
    });
  }

  set(ids, boxes) {
    const list = idsOf(ids);
    this.#withBoxes(boxes, (rows, count, allocate) => {
      expect(list.length === count, 'ids', `as many as boxes, ${count}`, list.length);
      check(wasm.hs_bvh_set(this.#bvh, copyIn(allocate, list), rows));
    });
  }

  erase(ids) {
    const list = idsOf(ids);
    const bvh = this.#open();
    withMemory((allocate) => check(wasm.hs_bvh_erase(bvh, copyIn(allocate, list), list.length)));
  }

  rebuild() { check(wasm.hs_bvh_rebuild(this.#open(), 0)); }
}

// The triangle mesh -------------------------------------------------------------------

const meshes = new FinalizationRegistry((mesh) => wasm.hs_mesh_destroy(mesh));

export class TriangleMesh {
  #mesh;
  #size;

  constructor(vertices, faces) {
    const points = floatsOf('vertices', vertices, 3);
    const indices = faces === undefined ? Uint32Array.from({ length: points.length / 3 }, (_, i) => i)
      : idsOf(faces, 'faces', 'the index of a vertex');
    expect(indices.length % 3 === 0, faces === undefined ? 'vertices' : 'faces',
      '3 for each triangle', indices.length);
    this.#size = indices.length / 3;
    this.#mesh = withRows(points, 3, (rows, _, allocate) => resultOf(wasm.hs_mesh_create(
      rows, copyIn(allocate, indices), this.#size, 0, oneResult)));
    meshes.register(this, this.#mesh, this);
  }

  dispose() {
    if (!this.#mesh) return;
    meshes.unregister(this);
    wasm.hs_mesh_destroy(this.#mesh);
    this.#mesh = 0;
  }

  #open() {
    if (!this.#mesh) throw new HalfspaceError('', 'the mesh was disposed of');
    return this.#mesh;
  }

  get size() { return this.#size; }

  raycastMany(rays) {
    const array = floatsOf('rays', rays, 7);
    const mesh = this.#open();
    const [ids, ts] = answers(array, 7, [1, 1],
      (rows, ...to) => wasm.hs_mesh_raycast(mesh, rows, 0, ...to));
    return { ids, ts };
  }

  occluded(rays) {
    const array = floatsOf('rays', rays, 7);
    const mesh = this.#open();
    return withRows(array, 7, (rows, count, allocate) => {
      const hits = allocate(count);
      check(wasm.hs_mesh_occluded(mesh, rows, 0, hits));
      return u8.slice(hits, hits + count);
    });
  }

  closestPoints(points, maxDistance = Infinity) {
    const array = floatsOf('points', points, 3);
    const limit = Number(maxDistance);
    const mesh = this.#open();
    const [ids, closest, distances] = answers(array, 3, [1, 3, 1],
      (rows, ...to) => wasm.hs_mesh_closest_points(mesh, rows, limit, 0, ...to));
    return { ids, distances, closest };
  }
}

if (Symbol.dispose) {
  for (const { prototype } of [BVH, TriangleMesh]) prototype[Symbol.dispose] = prototype.dispose;
}
