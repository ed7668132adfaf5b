// Compares the package with flatbush, rbush and kdbush, in one process and in turns:
//   node bench.mjs [BOXES...]
// in a folder where all four are installed. Each answer is checked first.
import { BVH } from 'halfspace';
import Flatbush from 'flatbush';
import RBush from 'rbush';
import KDBush from 'kdbush';

const QUERIES = 20000;
const REPETITIONS = 5;

// A generator of numbers in [0, 1) with a seed, so that all runs measure the same.
function random(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

// Rows of four floats, which are the same numbers for all libraries.
function boxesOf(count, side, next) {
  const boxes = new Float32Array(4 * count);
  for (let i = 0; i < 4 * count; i += 4) {
    boxes[i] = next();
    boxes[i + 1] = next();
    boxes[i + 2] = boxes[i] + side * next();
    boxes[i + 3] = boxes[i + 1] + side * next();
  }
  return boxes;
}

const median = (times) => times.sort((a, b) => a - b)[times.length >> 1];

// Times all cases in turns, and prints the median of each and its ratio to the first.
function compare(title, count, cases) {
  const sums = cases.map(([, run]) => run());
  for (const [i, sum] of sums.entries()) {
    if (sum !== sums[0]) throw new Error(`${title}: ${cases[i][0]} has other results: ${sum}, ${sums[0]}`);
  }
  const times = cases.map(() => []);
  for (let r = 0; r < REPETITIONS; ++r) {
    for (const [i, [, run]] of cases.entries()) {
      const begin = process.hrtime.bigint();
      run();
      times[i].push(Number(process.hrtime.bigint() - begin) / count);
    }
  }
  const ranges = times.map((t) => [median(t), Math.min(...t), Math.max(...t)]);
  for (const [i, [name]] of cases.entries()) {
    const [middle, least, most] = ranges[i];
    console.log(`${title.padEnd(22)} ${name.padEnd(20)} ${middle.toFixed(0).padStart(8)} ns ` +
      `[${least.toFixed(0)}, ${most.toFixed(0)}]  ${(middle / ranges[0][0]).toFixed(2)}`);
  }
}

for (const n of process.argv.length > 2 ? process.argv.slice(2).map(Number) : [1e4, 1e5, 1e6]) {
  const next = random(n);
  const side = 1 / Math.sqrt(n);
  const boxes = boxesOf(n, side, next);
  const queries = boxesOf(QUERIES, 4 * side, next);
  const points = Float32Array.from({ length: 2 * QUERIES }, next);
  const items = Array.from({ length: n }, (_, i) => ({
    minX: boxes[4 * i], minY: boxes[4 * i + 1], maxX: boxes[4 * i + 2], maxY: boxes[4 * i + 3], i,
  }));
  let tree, flat, bush, kd;
  compare(`${n}: build`, n, [
    ['halfspace', () => { tree?.dispose(); tree = new BVH(boxes); return n; }],
    ['halfspace, fast', () => { new BVH(boxes, { quality: 'fast' }).dispose(); return n; }],
    ['flatbush', () => {
      flat = new Flatbush(n, 16, Float32Array);
      for (let i = 0; i < 4 * n; i += 4) flat.add(boxes[i], boxes[i + 1], boxes[i + 2], boxes[i + 3]);
      flat.finish();
      return n;
    }],
    ['rbush', () => { bush = new RBush().load(items); return n; }],
  ]);
  kd = new KDBush(n, 64, Float32Array);
  for (let i = 0; i < 4 * n; i += 4) kd.add(boxes[i], boxes[i + 1]);
  kd.finish();
  const corners = new BVH(boxes.map((_, i) => boxes[4 * (i >> 2) + (i & 1)]));

  const each = (run) => () => {
    let sum = 0;
    for (let q = 0; q < 4 * QUERIES; q += 4) {
      sum += run(queries[q], queries[q + 1], queries[q + 2], queries[q + 3]);
    }
    return sum;
  };
  compare(`${n}: box query`, QUERIES, [
    ['halfspace', each((a, b, c, d) => tree.query([a, b, c, d]).length)],
    ['halfspace, many', () => tree.queryMany(queries).ids.length],
    ['flatbush', each((a, b, c, d) => flat.search(a, b, c, d).length)],
    ['rbush', each((a, b, c, d) => bush.search({ minX: a, minY: b, maxX: c, maxY: d }).length)],
  ]);
  compare(`${n}: points in a box`, QUERIES, [
    ['halfspace', each((a, b, c, d) => corners.query([a, b, c, d]).length)],
    ['kdbush', each((a, b, c, d) => kd.range(a, b, c, d).length)],
  ]);
  const eachPoint = (run) => () => {
    let sum = 0;
    for (let q = 0; q < 2 * QUERIES; q += 2) sum += run(points[q], points[q + 1]);
    return sum;
  };
  compare(`${n}: 8 nearest`, QUERIES, [
    ['halfspace', eachPoint((x, y) => tree.nearest([x, y], 8).length)],
    ['halfspace, many', () => tree.nearestMany(points, 8).ids.length],
    ['flatbush', eachPoint((x, y) => flat.neighbors(x, y, 8).length)],
  ]);
  tree.dispose();
  corners.dispose();
}
