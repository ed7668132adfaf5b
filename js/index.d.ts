/// <reference lib="esnext.disposable" />

/**
 * A bounding volume hierarchy of axis-aligned boxes in 2 or 3 dimensions.
 *
 * A box is 2 * dimensions numbers: all minima, then all maxima, in 2D minX, minY, maxX,
 * maxY. Boxes that only touch overlap. Boxes are stored as 32-bit floats. Numbers that are
 * no such floats are rounded outward: a query misses no overlap, and can find boxes that
 * are a rounding away. The id of a box is its index, or what insert() returned.
 *
 * A wrong argument throws a HalfspaceError that names it, and changes nothing. NaN and a
 * minimum above its maximum are errors. Infinity is a number.
 *
 * Each thread (page, worker) has a module of its own. A BVH goes to another thread as
 * bytes: toBytes() and fromBytes().
 */

/** Rows of numbers. Other arrays than the first two are copied. */
export type Numbers = Float32Array | Float64Array | ArrayLike<number>;

/** Results are arrays of an ArrayBuffer, and not of a SharedArrayBuffer. TypeScript can say
 * so since 5.7. */
export type Bytes = ReturnType<Uint8Array['slice']>;
export type Ids = ReturnType<Uint32Array['slice']>;
export type Floats = ReturnType<Float32Array['slice']>;

export interface Options {
  /** 2, by default, or 3. */
  dimensions?: 2 | 3;
  /** "high", by default. "fast" builds in a third of the time; queries take up to 1.4
   * times as long if the boxes are spread evenly, and up to 3 times in uneven worlds. */
  quality?: 'high' | 'fast';
  /** The extents of a typical query on each axis: 0 for points, Infinity where queries do
   * not limit an axis. Give them if the axes have unlike units (degrees and time), or if
   * queries are long on some axes. By default queries are about as large as the boxes. */
  queryExtents?: Numbers;
}

export class BVH {
  /** Builds a BVH of boxes, one after another. O(n log n). */
  constructor(boxes: Numbers, options?: Options);

  /** Reads what toBytes() wrote, here or in C++, C or Python. The bytes are copied. Damage
   * is found by a checksum, and is an error. */
  static fromBytes(bytes: Uint8Array | ArrayBuffer): BVH;
  /** The BVH as bytes of a format that other versions and languages read. */
  toBytes(): Bytes;

  readonly dimensions: 2 | 3;
  /** The number of boxes. */
  readonly size: number;
  /** One more than the greatest id: the size that an array by id needs. */
  readonly idLimit: number;
  /** The box around all boxes. */
  readonly bounds: Floats;

  /** The ids of the boxes that overlap a box, in no particular order. */
  query(box: ArrayLike<number>): Ids;
  /** The same for many boxes, in less time for each: the ids that overlap box i are
   * ids[offsets[i]] to ids[offsets[i + 1] - 1]. */
  queryMany(boxes: Numbers): { ids: Ids; offsets: Ids };

  /** The ids of the boxes that are at most `radius` from a point, in no particular order.
   * A box that is farther by 4 millionths, or by the rounding of the point, can be found. */
  within(point: ArrayLike<number>, radius: number): Ids;

  /** The ids of the k boxes nearest to a point, nearest first. A box that contains the
   * point has the distance 0. With `allTies`, also the boxes as far as the last of the k.
   * A box that is 2 ** 64 or farther away is not found. */
  nearest(point: ArrayLike<number>, k?: number, maxDistance?: number, allTies?: boolean):
    Ids;
  /** The same for many points. Row i is ids[i * k] to ids[i * k + k - 1], where k is that of
   * the result: at most `size`. If fewer boxes are near enough, the rest of
   * the row is NO_ID and Infinity. Distances are within a millionth of the exact ones. */
  nearestMany(points: Numbers, k?: number, maxDistance?: number):
    { k: number; ids: Ids; distances: Floats };

  /** The first box that a ray enters, or null. The hit is at origin + t * direction, with t
   * from 0 to maxT. Coordinates are rounded to 32-bit floats. */
  raycast(origin: ArrayLike<number>, direction: ArrayLike<number>, maxT?: number):
    { id: number; t: number } | null;
  /** The same for rows of an origin, a direction and a limit of t: 2 * dimensions + 1
   * numbers. Without a hit, the id is NO_ID and t is Infinity. */
  raycastMany(rays: Numbers): { ids: Ids; ts: Floats };

  /** All pairs of boxes that overlap, or are at most `margin` apart on each axis: pair i is
   * elements 2 * i and 2 * i + 1. Each pair is there once. */
  pairs(margin?: number): Ids;
  /** The pairs of a box of this BVH and one of another, in this order. */
  join(other: BVH, margin?: number): Ids;

  /** Adds boxes, and returns their ids. */
  insert(boxes: Numbers): Ids;
  /** Removes boxes. Their ids can be given to boxes that are inserted later. */
  erase(ids: ArrayLike<number>): void;
  /** Replaces boxes: box i is that of ids[i]. */
  set(ids: ArrayLike<number>, boxes: Numbers): void;
  /** Sorts all boxes again: queries are then as fast as after a build. Ids stay. */
  rebuild(): void;

  /** Frees the memory at once. Without it, the garbage collector does. */
  dispose(): void;
  /** The same, for `using tree = new BVH(boxes)`. */
  [Symbol.dispose](): void;
}

/**
 * Triangles that do not move. The id of a triangle is its index. All numbers are rounded to
 * 32-bit floats. From there on it is exact whether a ray hits a triangle: none passes between
 * triangles that share an edge. A ray through the edge hits both, so the parity of hits does
 * not say whether a point is inside of a closed mesh. A triangle without an area, or in whose
 * plane the ray lies, is not hit. A triangle with an infinity is never found.
 */
export class TriangleMesh {
  /** Copies the vertices, 3 numbers each. Faces are 3 indices of vertices each. Without
   * faces, 3 vertices one after another are a triangle. O(n log n). */
  constructor(vertices: Numbers, faces?: ArrayLike<number>);

  /** The number of triangles. */
  readonly size: number;

  /** The first triangle that each ray hits, from either side. A ray is 7 numbers: an origin,
   * a direction and a limit of t. Without a hit, the id is NO_ID and t is Infinity. */
  raycastMany(rays: Numbers): { ids: Ids; ts: Floats };
  /** 1 for each ray that hits a triangle, and 0 for the others. */
  occluded(rays: Numbers): Bytes;
  /** The triangle that is closest to each point, the distance, and the closest point of the
   * triangle, which is 3 numbers. If there is none within `maxDistance`, they are NO_ID,
   * Infinity and NaN. */
  closestPoints(points: Numbers, maxDistance?: number):
    { ids: Ids; distances: Floats; closest: Floats };

  /** Frees the memory at once. Without it, the garbage collector does. */
  dispose(): void;
  /** The same, for `using mesh = new TriangleMesh(vertices)`. */
  [Symbol.dispose](): void;
}

/** The id that stands for "none" in nearestMany(), raycastMany() and closestPoints(). */
export const NO_ID: 4294967295;

/** The version of the library. */
export const version: string;

export class HalfspaceError extends Error {
  /** The argument that is wrong, as "boxes[7]", or "". */
  argument: string;
}
