// The package as it is installed: run by test.sh, with the folder of stored BVHs.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import { inspect } from 'node:util';
import vm from 'node:vm';
import * as halfspace from 'halfspace';
import { hasChromium, postedBy } from './chromium.mjs';

const { BVH, NO_ID, TriangleMesh } = halfspace;
const data = process.env.HALFSPACE_TEST_DATA;

// Numbers in [0, 1), the same in each run.
const random = (state) => () =>
  (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;

// Boxes of numbers that are floats, some of them points, some on a grid, and some far away.
const someBoxes = (count, dimensions, next) => Array.from({ length: count }, () => {
  const scale = next() < 0.02 ? 1000 : 10;
  const round = next() < 0.5 ? Math.fround : Math.round;
  const min = axes(dimensions).map(() => round(scale * next()));
  const side = next() < 0.1 ? 0 : 1;
  return [...min, ...min.map((v) => Math.fround(v + side * next()))];
});

const axes = (dimensions) => [...Array(dimensions).keys()];
const overlap = (a, b, d, margin = 0) =>
  axes(d).every((k) => a[k] <= b[d + k] + margin && b[k] <= a[d + k] + margin);
const distance = (box, p, d) =>
  Math.hypot(...axes(d).map((k) => Math.max(0, box[k] - p[k], p[k] - box[d + k])));
const around = (boxes, d) => axes(2 * d).map((k) =>
  Math[k < d ? 'min' : 'max'](...boxes.map((box) => box[k])));
const sorted = (ids) => Array.from(ids).sort((a, b) => a - b);
const pairsOf = (ids, ordered) => sorted(Array.from({ length: ids.length / 2 }, (_, i) => {
  const [a, b] = [ids[2 * i], ids[2 * i + 1]];
  return ordered || a < b ? 1e6 * a + b : 1e6 * b + a;
}));

// All calls, against a map of ids and boxes.
function checkAnswers(tree, boxes, next) {
  const d = tree.dimensions;
  const all = [...boxes];
  assert.equal(tree.size, boxes.size);
  const touching = (query, margin = 0) =>
    all.filter(([, box]) => overlap(box, query, d, margin)).map(([id]) => id);
  const queries = someBoxes(20, d, next);
  const points = queries.map((query) => query.slice(0, d));
  const many = tree.queryMany(Float64Array.from(queries.flat()));
  const nearest = tree.nearestMany(Float32Array.from(points.flat()), 5);
  assert.equal(nearest.k, Math.min(5, boxes.size));
  // Along an axis a ray enters at the minimum of what it meets.
  const axis = axes(d).map((k) => (k === 0 ? 1 : 0));
  for (const [q, query] of queries.entries()) {
    const point = points[q];
    for (const ids of [tree.query(query), many.ids.slice(many.offsets[q], many.offsets[q + 1])]) {
      assert.deepEqual(sorted(ids), sorted(touching(query)));
    }
    const expected = sorted(all.map(([, box]) => distance(box, point, d)));
    const near = tree.nearest(point, 5);
    assert.deepEqual(near, nearest.ids.slice(q * nearest.k, (q + 1) * nearest.k));
    near.forEach((id, i) => {
      const said = nearest.distances[q * nearest.k + i];
      for (const value of [distance(boxes.get(id), point, d), said]) {
        assert.ok(Math.abs(value - expected[i]) <= 2e-6 * expected[i]);
      }
    });
    const limit = expected[2] ?? expected.at(-1) ?? 1;
    for (const ids of [tree.nearest(point, Infinity, 1.001 * limit), tree.within(point, limit),
      tree.nearest(point, 3, Infinity, true)]) {
      assert.ok(ids.every((id) => distance(boxes.get(id), point, d) <= 1.002 * limit));
      assert.ok(ids.length >= expected.filter((value) => value <= limit).length);
    }

    const origin = [-1, ...point.slice(1)];
    const met = touching([0, ...point.slice(1), Infinity, ...point.slice(1)]);
    const first = 1 + Math.min(...met.map((id) => boxes.get(id)[0]));
    const t = tree.raycast(origin, axis)?.t ?? Infinity;
    assert.ok(t <= first && t >= first * (1 - 1e-5));
    assert.equal(tree.raycast(origin, axis, 0.9 * Math.min(first, 1e9)), null);
  }
  for (const margin of [0, 0.5]) {
    const expected = all.flatMap(([a, box]) =>
      touching(box, margin).filter((b) => a < b).flatMap((b) => [a, b]));
    assert.deepEqual(pairsOf(tree.pairs(margin)), pairsOf(expected));
  }
  const few = queries.filter((_, i) => i % 3 === 0);
  assert.deepEqual(pairsOf(new BVH(few.flat(), { dimensions: d }).join(tree), true),
    pairsOf(few.flatMap((query, i) => touching(query).flatMap((id) => [i, id])), true));
}

for (const dimensions of [2, 3]) {
  test(`any history of boxes in ${dimensions} dimensions`, () => {
    for (const count of [0, 1, 65, 600]) {
      const next = random(count + dimensions);
      const some = (n) => someBoxes(n, dimensions, next);
      const boxes = new Map(some(count).map((box, id) => [id, box]));
      const rows = Float32Array.from([...boxes.values()].flat());
      let tree = new BVH(rows, { dimensions, quality: count === 65 ? 'fast' : 'high' });
      for (let step = 0; step < 4; ++step) {
        checkAnswers(tree, boxes, next);
        const added = some(30);
        tree.insert(added.flat()).forEach((id, i) => {
          assert.ok(!boxes.has(id));
          boxes.set(id, added[i]);
        });
        const ids = [...boxes.keys()].filter(() => next() < 0.2);
        tree.erase(ids);
        ids.forEach((id) => boxes.delete(id));
        const moved = [...boxes.keys()].filter(() => next() < 0.3);
        const to = some(moved.length);
        tree.set(moved, to.flat());
        moved.forEach((id, i) => boxes.set(id, to[i]));
        if (step === 1) tree.rebuild();
        if (step === 2) {
          const old = tree;
          tree = BVH.fromBytes(old.toBytes().buffer);
          old.dispose();
        }
      }
      checkAnswers(tree, boxes, next);
      assert.deepEqual([...tree.bounds], around([...boxes.values()], dimensions));
      assert.ok(tree.idLimit > Math.max(...boxes.keys()));
    }
  });
}

test('arrays of other classes and realms', () => {
  class Points extends Float32Array {
    constructor(count) { super(2 * count); }
  }
  const boxes = new Points(2);
  boxes.set([0, 0, 1, 1]);
  const other = (code) => vm.runInNewContext(code, { bytes: new BVH(boxes).toBytes() });
  for (const rows of [boxes, other('new Float32Array([0, 0, 1, 1])'),
    other('[0, 0, 1, 1]'), { length: 4, 0: 0, 1: 0, 2: 1, 3: 1 }]) {
    assert.deepEqual([...new BVH(rows).query([1, 1, 2, 2])], [0]);
  }
  for (const bytes of [other('Uint8Array.from(bytes)'), other('Uint8Array.from(bytes).buffer')]) {
    assert.deepEqual([...BVH.fromBytes(bytes).query([1, 1, 2, 2])], [0]);
  }
  const tree = new BVH(boxes);
  tree.erase(other('Uint32Array.of(0)'));
  assert.equal(tree.size, 0);
  for (const faces of [Uint16Array.of(0, 1, 2), other('Uint32Array.of(0, 1, 2)')]) {
    assert.equal(new TriangleMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], faces).size, 1);
  }
});

test('the bytes of no boxes', () => {
  for (const dimensions of [2, 3]) {
    const tree = BVH.fromBytes(new BVH([], { dimensions }).toBytes());
    assert.deepEqual([tree.size, tree.dimensions], [0, dimensions]);
    assert.deepEqual([...tree.insert(new Float32Array(2 * dimensions))], [0]);
  }
});

test('more results than 2 ** 32', () => {
  const tree = new BVH(new Float32Array(4 * 65536));
  assert.throws(() => tree.queryMany(new Float32Array(4 * 65537)), /out of memory/);
  assert.throws(() => tree.join(new BVH(new Float32Array(4 * 65537))), /out of memory/);
  assert.equal(tree.query([0, 0, 0, 0]).length, 65536);
});

test('a point whose numbers come from a call of the module', () => {
  const tree = new BVH([0, 0, 1, 1, 5, 5, 6, 6]);
  const five = { valueOf: () => { tree.nearest([0, 0]); return 5; } };
  assert.deepEqual([...tree.nearest({ length: 2, 0: 5, get 1() { return +five; } }, 1, five)], [1]);
});

// Vectors of 3 numbers.
const minus = (a, b) => a.map((value, k) => value - b[k]);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = (a, b) => a.map((_, k) =>
  a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
const edgesOf = ([a, b, c]) => [[a, b], [b, c], [c, a]];
const normalOf = ([a, b, c]) => cross(minus(b, a), minus(c, a));

// Where a ray hits a triangle. Without rounding errors if all are small whole numbers.
function hit([origin, direction, limit], triangle) {
  const along = dot(normalOf(triangle), direction);
  const t = dot(normalOf(triangle), minus(triangle[0], origin)) / along;
  const isInside = edgesOf(triangle).every(([a, b]) =>
    along * dot(cross(minus(a, origin), minus(b, origin)), direction) >= 0);
  return along !== 0 && isInside && t >= 0 && t <= limit ? t : Infinity;
}

// How far a point is from a triangle: along the normal, or else from an edge.
function away(point, triangle) {
  const normal = normalOf(triangle);
  return Math.min(...[1, -1].map((sign) => (Math.hypot(...normal) || 1) *
    hit([point, normal.map((value) => sign * value), Infinity], triangle)),
  ...edgesOf(triangle).map(([a, b]) => {
    const edge = minus(b, a);
    const t = Math.min(1, Math.max(0, dot(edge, minus(point, a)) / dot(edge, edge) || 0));
    return Math.hypot(...minus(point, a.map((value, k) => value + t * edge[k])));
  }));
}

test('rays that hit triangles, and closest points', () => {
  const next = random(9);
  const some = (count, make) => Array.from({ length: count }, make);
  const place = (size) => axes(3).map(() => Math.floor(size * next()));
  const triangles = some(300, () => {
    const at = place(20);
    return some(3, () => place(6).map((value, k) => at[k] + value));
  });
  const corners = triangles.flat(2);
  const isNear = (a, b) => a === b || Math.abs(a - b) <= 1e-6 * (1 + b);
  const indices = triangles.flatMap((_, i) => [3 * i, 3 * i + 1, 3 * i + 2]);
  for (const faces of [undefined, indices]) {
    const mesh = new TriangleMesh(Float32Array.from(corners), faces);
    assert.equal(mesh.size, 300);
    const rays = some(200, () =>
      [place(25), minus(place(7), [3, 3, 3]), next() < 0.5 ? 3 : Infinity]);
    const points = some(200, () => place(30));
    const hits = mesh.raycastMany(rays.flat(2));
    const near = mesh.closestPoints(points.flat(), 4.1);
    assert.deepEqual([...mesh.occluded(rays.flat(2))],
      [...hits.ids].map((id) => (id === NO_ID ? 0 : 1)));
    for (const [ids, values, rows, measure] of [[hits.ids, hits.ts, rays, hit],
      [near.ids, near.distances, points, (...of) => (away(...of) < 4.1 ? away(...of) : Infinity)]]) {
      assert.ok(ids.includes(NO_ID) && ids.some((id) => id !== NO_ID));
      rows.forEach((row, i) => {
        const measured = triangles.map((triangle) => measure(row, triangle));
        const least = Math.min(...measured);
        assert.ok(isNear(values[i], least));
        assert.ok(isNear(measured[ids[i]] ?? Infinity, least));
      });
    }
    near.ids.forEach((id, i) => {
      if (id === NO_ID) return;
      const closest = near.closest.slice(3 * i, 3 * i + 3);
      assert.ok(isNear(Math.hypot(...minus(points[i], closest)), near.distances[i]));
      assert.ok(isNear(away([...closest], triangles[id]), 0));
    });
    mesh.dispose();
    mesh.dispose();
    assert.throws(() => mesh.occluded([]), /disposed/);
  }
});

test('doubles are rounded outward, and Infinity is a number', () => {
  const tree = new BVH([0.1, 0.1, 0.7, 0.7]);
  assert.ok(tree.bounds[0] < 0.1 && tree.bounds[2] > 0.7);
  assert.deepEqual([...tree.query([-Infinity, -Infinity, 0.1, Infinity])], [0]);
  assert.deepEqual([...tree.within([Infinity, 0], 1)], [0]);
  // 2 ** 24 + 1 is no float.
  assert.equal(new BVH([2 ** 24 + 2, 0, 2 ** 25, 1]).within([2 ** 24 + 1, 0.1], 1).length, 1);
});

test('more results than there was room for, and memory that grows', () => {
  const tree = new BVH(new Float32Array(4 * 100000));
  const view = tree.bounds;
  assert.equal(tree.query([0, 0, 1, 1]).length, 100000);
  assert.equal(tree.nearest([0, 0], 2, 1, true).length, 100000);
  assert.equal(tree.queryMany(new Float32Array(40)).ids.length, 1000000);
  assert.ok(view.length === 4 && view.every((value) => value === 0));
  assert.throws(() => tree.nearestMany(new Float32Array(2 * 20000), 100000), /out of memory/);
  assert.equal(tree.nearest([0, 0]).length, 1);
});

test('stored BVHs of C++', () => {
  const bytes = readFileSync(`${data}/boxes.5.bvh`);
  const tree = BVH.fromBytes(bytes);
  assert.equal(tree.query([...tree.bounds]).length, tree.size);
  assert.deepEqual(Buffer.from(tree.toBytes()), bytes);
});

// Writes the checksum that the bytes should have (ChecksumOf of dispatch/bvh/blob.cc).
function withChecksum(bytes) {
  const words = new BigUint64Array(bytes.buffer);
  const mix = (sum, word) => {
    const product = BigInt.asUintN(64, (sum ^ word) * 0x9E3779B97F4A7C15n);
    return product ^ (product >> 32n);
  };
  words[3] = 0n;
  const sums = Array(8).fill(0n);
  words.forEach((word, i) => { sums[i % 8] = mix(sums[i % 8], word); });
  words[3] = sums.reduce(mix, 0n);
  return bytes;
}

test('bytes that were altered with their checksum', () => {
  const one = new BVH([0, 0, 1, 1]).toBytes();
  assert.equal(BVH.fromBytes(withChecksum(one.slice())).size, 1);
  // The bytes for so many boxes are 5056 more than 2 ** 32.
  const large = new Uint8Array(5056);
  large.set(one);
  new Uint32Array(large.buffer).set([large.length], 4);
  new Uint32Array(large.buffer).set([151238913], 8);
  assert.throws(() => BVH.fromBytes(withChecksum(large)), { name: 'HalfspaceError' });
  // There are seven boxes, and the header has one.
  const seven = new BVH(Array(8).fill([0, 0, 1, 1]).flat());
  seven.erase([7]);
  const altered = seven.toBytes();
  new Uint32Array(altered.buffer).set([1], 11);
  const tree = BVH.fromBytes(withChecksum(altered));
  assert.ok(tree.nearest([0, 0], 1, Infinity, true).length > 0);
  assert.throws(() => tree.insert([0, 0, 1, 1]), { name: 'HalfspaceError' });
});

const flat = new BVH([0, 0, 1, 1]);
const mesh = new TriangleMesh([0, 0, 0, 1, 0, 0, 0, 1, 0]);
const gone = new BVH([]);
gone.dispose();
gone.dispose();
const detached = new Float32Array(8);
structuredClone(detached.buffer, { transfer: [detached.buffer] });
const detachedIds = new Uint32Array(1);
structuredClone(detachedIds.buffer, { transfer: [detachedIds.buffer] });
const transferred = flat.toBytes();
structuredClone(transferred.buffer, { transfer: [transferred.buffer] });
const outside = new Float32Array(new ArrayBuffer(32, { maxByteLength: 32 }), 16, 4);
const canResize = 'resize' in outside.buffer;
if (canResize) outside.buffer.resize(8);
const altered = flat.toBytes();
altered[altered.length - 1] ^= 1;
for (const [argument, call] of [
  ['boxes', () => new BVH(null)],
  ['boxes', () => new BVH('0011')],
  ['boxes', () => new BVH([1, 2, 3])],
  ['boxes', () => new BVH(detached)],
  ['boxes', () => new BVH(canResize ? outside : detached)],
  ['boxes', () => new BVH({ length: -4 })],
  ['boxes[1]', () => new BVH([0, '0', 1, 1])],
  ['boxes[0]', () => new BVH(Float32Array.of(NaN, 0, 1, 1))],
  ['boxes[5]', () => new BVH([0, 0, 1, 1, 0, 2, 1, 1])],
  ['dimensions', () => new BVH([], { dimensions: 4 })],
  ['quality', () => new BVH([], { quality: 'best' })],
  ['box', () => flat.query([0, 0, 1])],
  ['box[0]', () => flat.query([2, 0, 1, 1])],
  ['point[0]', () => flat.nearest([Symbol('x'), 0])],
  ['k', () => flat.nearest([0, 0], 0)],
  ['k', () => flat.nearest([0, 0], 1.5)],
  ['point', () => flat.within([0], 1)],
  ['radius', () => flat.within([0, 0], NaN)],
  ['maxDistance', () => flat.nearestMany([0, 0], 1, NaN)],
  ['origin[0]', () => flat.raycast([NaN, 0], [1, 0])],
  ['direction', () => flat.raycast([0, 0], [1])],
  ['rays[3]', () => flat.raycastMany(Float32Array.of(0, 0, 1, NaN, 9))],
  ['maxT', () => flat.raycast([0, 0], [1, 0], -1)],
  ['vertices', () => new TriangleMesh([0, 0])],
  ['vertices', () => new TriangleMesh([0, 0, 0])],
  ['vertices[1]', () => new TriangleMesh([0, NaN, 0])],
  ['faces', () => new TriangleMesh([0, 0, 0], [0])],
  ['faces[2]', () => new TriangleMesh([0, 0, 0], [0, 0, 1])],
  ['faces[1]', () => new TriangleMesh([0, 0, 0], [0, -1, 0])],
  ['rays', () => mesh.raycastMany([0])],
  ['rays', () => mesh.occluded([0, 0, 0, 1, 0, 0, -1])],
  ['points[2]', () => mesh.closestPoints([0, 0, NaN])],
  ['maxDistance', () => mesh.closestPoints([0, 0, 0], -1)],
  ['margin', () => flat.pairs(1e39)],
  ['other', () => flat.join({})],
  ['other', () => flat.join(new BVH([], { dimensions: 3 }))],
  ['', () => flat.join(gone)],
  ['ids', () => flat.erase(0)],
  ['ids[0]', () => flat.erase([1])],
  ['ids[0]', () => flat.erase([0.5])],
  ['ids', () => flat.set([0, 0], [0, 0, 1, 1])],
  ['ids', () => flat.erase(detachedIds)],
  ['bytes', () => BVH.fromBytes([1])],
  ['bytes', () => BVH.fromBytes(transferred)],
  ['bytes', () => BVH.fromBytes(new Uint8Array(0))],
  ['bytes', () => BVH.fromBytes(altered)],
  ['bytes', () => BVH.fromBytes(readFileSync(`${data}/octahedra.5.bvh`))],
  ['', () => gone.query([0, 0, 1, 1])],
]) {
  test(`misuse: ${call}`, () => {
    assert.throws(call,
      { name: 'HalfspaceError', argument, message: /expected|detached|disposed/ });
    assert.deepEqual([...flat.query([0, 0, 1, 1])], [0]);
  });
}

test('the types name what there is', () => {
  const types = readFileSync(new URL('./node_modules/halfspace/index.d.ts', import.meta.url), 'utf8');
  const names = Object.getOwnPropertyNames(BVH.prototype);
  for (const name of [...names, 'fromBytes', ...Object.keys(halfspace)]) {
    assert.match(types, new RegExp(`\\b${name}\\b[(:; ]`), name);
  }
  assert.equal(NO_ID, 2 ** 32 - 1);
});

// An old node refuses to require() any ES module.
const canRequire = process.features.require_module;
test('require()', { skip: !canRequire && 'this node cannot' }, () => {
  assert.equal(createRequire(import.meta.url)('halfspace').BVH, BVH);
});

const esbuild = '/usr/bin/esbuild';
for (const format of ['iife', 'cjs']) {
  test(`a bundle: ${format}`, { skip: !existsSync(esbuild) && 'there is no esbuild' }, () => {
    execFileSync(esbuild, ['example.mjs', '--bundle', `--format=${format}`, '--target=es2017',
      `--outfile=${format}.cjs`]);
    assert.match(String(execFileSync(process.execPath, [`${format}.cjs`])), /id: 0, t: 0.99/);
  });
}

test('init()', () => {
  // In a process of its own, as `halfspace` has started the module of this one.
  const script = `
    import { readFileSync } from 'node:fs';
    import { BVH, HalfspaceError, init, version } from 'halfspace/init';
    import assert from 'node:assert/strict';
    assert.throws(() => new BVH([]), HalfspaceError);
    await assert.rejects(init(new Uint8Array(9)), WebAssembly.CompileError);
    const bytes = readFileSync(new URL(import.meta.resolve('halfspace/halfspace.wasm')));
    const first = init(bytes);
    assert.equal(init(), first);
    await first;
    const tree = new BVH([0, 0, 1, 1]);
    assert.equal((await import('halfspace')).version, version);
    console.log(tree.query([1, 1, 2, 2]).length + new BVH([]).size);`;
  assert.equal(String(execFileSync(process.execPath, ['--input-type=module', '-e', script])), '1\n');
});

test('the example of the README, in node and in Chromium', async (t) => {
  // As JSON: the formats of the consoles differ.
  const lines = [], shown = [];
  t.mock.method(console, 'log', (...values) => {
    lines.push(JSON.stringify(values));
    shown.push(values.map((value) => inspect(value)).join(' '));
  });
  await import('./example.mjs');
  assert.deepEqual(shown, readFileSync('example.mjs', 'utf8').match(/(?<=^console.*\/\/ ).*/gm));
  if (!hasChromium) return t.skip('there is no chromium');
  assert.equal(await postedBy(`<!DOCTYPE html><script type="importmap">
    {"imports": {"halfspace": "/node_modules/halfspace/index.js"}}</script>
    <script type="module">
    import { BVH, init } from '/node_modules/halfspace/init.js';
    const lines = [];
    console.log = (...values) => lines.push(JSON.stringify(values));
    try {
      await init();
      new BVH([0, 0, 1, 1]).dispose();
      await import('/example.mjs');
    } catch (error) { lines.push(String(error)); }
    await fetch('/posted', { method: 'POST', body: lines.join('\\n') });
    </script>`), lines.join('\n'));
});
