// Compares the package with flatbush and rbush, in one process and in turns:
//   node bench.mjs [BOXES...]
// in a folder where all three are installed. The numbers of results are compared.
import { BVH } from 'halfspace';
import Flatbush from 'flatbush';
import RBush from 'rbush';

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
  const sums = new Set();
  for (let r = 0; r < REPETITIONS; ++r) {
    for (const [i, [, run]] of cases.entries()) {
      const begin = performance.now();
      sums.add(run());
      times[i].push((performance.now() - begin) * 1e6 / count);
    }
  }
  if (sums.size > 1) throw new Error(`${title}: other results: ${[...sums]}`);
  for (const [i, [name]] of cases.entries()) {
    const [least, , middle, , most] = times[i].sort((a, b) => a - b);
    console.log(title.padEnd(22), name.padEnd(20), middle.toFixed(0).padStart(8), 'ns',
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
  const queries = boxesOf(QUERIES, 4 * side, next);
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
  compare(`${n}: box query`, QUERIES, [
    ['halfspace', each(queries, 4, (a, b, c, d) => tree.query([a, b, c, d]).length)],
    ['halfspace, many', () => tree.queryMany(queries).ids.length],
    ['flatbush', each(queries, 4, (a, b, c, d) => flat.search(a, b, c, d).length)],
    ['rbush', each(queries, 4, (minX, minY, maxX, maxY) =>
      bush.search({ minX, minY, maxX, maxY }).length)],
  ]);
  compare(`${n}: 8 nearest`, QUERIES, [
    ['halfspace', each(points, 2, (x, y) => tree.nearest([x, y], 8).length)],
    ['halfspace, many', () => tree.nearestMany(points, 8).ids.length],
    ['flatbush', each(points, 2, (x, y) => flat.neighbors(x, y, 8).length)],
  ]);
}
