// Compares the package with flatbush, rbush, kdbush and three-mesh-bvh, in one process and in
// turns:
//   node bench.mjs [BOXES...]
// in a folder where all five and three are installed. The numbers of results are compared.
import { BVH, NO_ID, TriangleMesh } from 'halfspace';
import Flatbush from 'flatbush';
import KDBush from 'kdbush';
import RBush from 'rbush';
import { BufferAttribute, BufferGeometry, DoubleSide, Ray, TorusKnotGeometry, Vector3 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';

const QUERIES = 20000;
const REPETITIONS = 5;

// Numbers in [0, 1) with a seed, so that all runs measure the same.
const random = (state) => () =>
  (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;

// Rows of four floats, which are the same numbers for all libraries.
const boxesOf = (count, side, next) => Float32Array.from(Array.from({ length: count }, () => {
  const [x, y] = [next(), next()];
  return [x, y, x + side * next(), y + side * next()];
}).flat());

// Times all cases in turns, and prints the median of each, its range, and its ratio to the
// first.
function compare(title, count, cases) {
  const times = cases.map(() => []);
  const sums = [];
  for (let r = 0; r < REPETITIONS; ++r) {
    for (const [i, [, run]] of cases.entries()) {
      const begin = performance.now();
      sums.push(run());
      times[i].push((performance.now() - begin) * 1e6 / count);
    }
  }
  // within() also finds points that are farther by 4 millionths.
  if (Math.max(...sums) > 1.00001 * Math.min(...sums)) {
    throw new Error(`${title}: other results: ${sums}`);
  }
  for (const [i, [name]] of cases.entries()) {
    const [least, , middle, , most] = times[i].sort((a, b) => a - b);
    console.log(title.padEnd(26), name.padEnd(20), middle.toFixed(0).padStart(8), 'ns',
      `[${least.toFixed(0)}, ${most.toFixed(0)}]`, (middle / times[0][2]).toFixed(2));
  }
}

// The sum of run() of each row of so many numbers.
const each = (rows, values, run) => () => {
  let sum = 0;
  for (let i = 0; i < rows.length; i += values) {
    sum += run(rows[i], rows[i + 1], rows[i + 2], rows[i + 3]);
  }
  return sum;
};

for (const n of process.argv.length > 2 ? process.argv.slice(2).map(Number) : [1e4, 1e5, 1e6]) {
  const next = random(n);
  const side = 1 / Math.sqrt(n);
  const boxes = boxesOf(n, side, next);
  const points = Float32Array.from({ length: 2 * QUERIES }, next);
  const items = [];
  each(boxes, 4, (minX, minY, maxX, maxY) => items.push({ minX, minY, maxX, maxY }))();
  let tree, flat, bush;
  compare(`${n}: build`, n, [
    ['halfspace', () => { tree?.dispose(); tree = new BVH(boxes); }],
    ['halfspace, fast', () => new BVH(boxes, { quality: 'fast' }).dispose()],
    ['flatbush', () => {
      flat = new Flatbush(n, 16, Float32Array);
      each(boxes, 4, (a, b, c, d) => flat.add(a, b, c, d))();
      flat.finish();
    }],
    ['rbush', () => { bush = new RBush().load(items); }],
  ]);
  for (const [results, width, far] of [['no result', 4, 2], ['8 results', 4, 0], ['130 results', 20, 0]]) {
    const queries = boxesOf(QUERIES, width * side, () => far + next());
    compare(`${n}: ${results}`, QUERIES, [
      ['halfspace', each(queries, 4, (a, b, c, d) => tree.query([a, b, c, d]).length)],
      ['halfspace, many', () => tree.queryMany(queries).ids.length],
      ['flatbush', each(queries, 4, (a, b, c, d) => flat.search(a, b, c, d).length)],
      ['rbush', each(queries, 4, (minX, minY, maxX, maxY) =>
        bush.search({ minX, minY, maxX, maxY }).length)],
    ]);
  }
  compare(`${n}: 8 nearest`, QUERIES, [
    ['halfspace', each(points, 2, (x, y) => tree.nearest([x, y], 8).length)],
    ['halfspace, many', () => tree.nearestMany(points, 8).ids.length],
    ['flatbush', each(points, 2, (x, y) => flat.neighbors(x, y, 8).length)],
  ]);

  // Points are boxes without extents.
  const places = Float32Array.from({ length: 2 * n }, next);
  const rows = new Float32Array(4 * n).map((_, i) => places[2 * (i >> 2) + (i & 1)]);
  let kd;
  compare(`${n} points: build`, n, [
    ['halfspace', () => { tree.dispose(); tree = new BVH(rows); }],
    ['kdbush', () => {
      kd = new KDBush(n, 64, Float32Array);
      each(places, 2, (x, y) => kd.add(x, y))();
      kd.finish();
    }],
  ]);
  compare(`${n} points: within`, QUERIES, [
    ['halfspace', each(points, 2, (x, y) => tree.within([x, y], 1.6 * side).length)],
    ['kdbush', each(points, 2, (x, y) => kd.within(x, y, 1.6 * side).length)],
  ]);
  tree.dispose();
}

const knot = new TorusKnotGeometry(1, 0.3, 500, 100);
const [vertices, faces] = [knot.attributes.position.array, knot.index.array];
const next = random(1);
const around = () => 4 * next() - 2;
const points = Float32Array.from({ length: 3 * QUERIES }, around);
const rays = new Float32Array(7 * QUERIES).map((_, i) => (i % 7 < 6 ? around() : Infinity));
// Unit vectors, as three-mesh-bvh expects.
for (let i = 3; i < rays.length; i += 7) {
  new Vector3().fromArray(rays, i).normalize().toArray(rays, i);
}
let mesh, bvh;
compare('100000 triangles: build', faces.length / 3, [
  ['halfspace', () => { mesh?.dispose(); mesh = new TriangleMesh(vertices, faces); }],
  ['three-mesh-bvh', () => {
    const copy = new BufferGeometry().setIndex(new BufferAttribute(faces.slice(), 1));
    bvh = new MeshBVH(copy.setAttribute('position', new BufferAttribute(vertices, 3)));
  }],
]);
const [ray, point] = [new Ray(), new Vector3()];
const eachOf = (array, values, run) => () => {
  let sum = 0;
  for (let i = 0; i < array.length; i += values) sum += run(i);
  return sum;
};
compare('100000 triangles: ray', QUERIES, [
  ['halfspace, many', () => mesh.raycastMany(rays).ids.filter((id) => id !== NO_ID).length],
  ['halfspace', eachOf(rays, 7, (i) =>
    Number(mesh.raycastMany(rays.subarray(i, i + 7)).ids[0] !== NO_ID))],
  ['three-mesh-bvh', eachOf(rays, 7, (i) => {
    ray.origin.fromArray(rays, i);
    ray.direction.fromArray(rays, i + 3);
    return Number(bvh.raycastFirst(ray, DoubleSide) !== null);
  })],
]);
compare('100000 triangles: closest', QUERIES, [
  ['halfspace, many', () => mesh.closestPoints(points).distances.reduce((a, b) => a + b, 0)],
  ['halfspace', eachOf(points, 3, (i) => mesh.closestPoints(points.subarray(i, i + 3)).distances[0])],
  ['three-mesh-bvh', eachOf(points, 3, (i) =>
    bvh.closestPointToPoint(point.fromArray(points, i)).distance)],
]);
