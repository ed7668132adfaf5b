// The broad phase against every body.
#include <math.h>
#include <stdlib.h>

#include "check.h"

enum { IDS = 900, QUERIES = 60, VALUES = 8 };
#define ALL UINT64_MAX

// What the broad phase should contain.
typedef struct model {
  hs_kind kind;
  size_t values;
  int has[IDS];
  float bounds[IDS * VALUES];
  hs_body_masks masks[IDS];
  unsigned char pairs[IDS][IDS];  // of the last call of check_pairs()
} model;

static model its;
static hs_broad_phase* bodies;

static hs_broad_phase_config config_of(hs_kind kind) {
  hs_broad_phase_config config;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = kind;
  config.max_ids = IDS;
  return config;
}

static const float* bound_of(size_t id) { return its.bounds + id * its.values; }

// The bodies that queries found.
typedef struct found {
  size_t calls;
  size_t stop_after;
  unsigned char has[QUERIES][IDS];
  float ts[QUERIES][IDS];
} found;

static found got;

static hs_visit take_body(void* context, size_t query, uint32_t id,
                          const float* bound) {
  CHECK(context == &got && query < QUERIES && id < IDS && its.has[id]);
  CHECK(memcmp(bound, bound_of(id), its.values * sizeof(float)) == 0);
  CHECK(!got.has[query][id]);
  got.has[query][id] = 1;
  return ++got.calls == got.stop_after ? HS_STOP : HS_CONTINUE;
}

static float take_hit(void* context, size_t cast, uint32_t id, float t,
                      const float* bound) {
  got.ts[cast][id] = t;
  return take_body(context, cast, id, bound) == HS_STOP ? -1.0f : INFINITY;
}

static int is_in_mask(size_t id, uint64_t mask) {
  return mask == ALL || (its.masks[id].category & mask) != 0;
}

static void check_bounds(const float* queries, const hs_columns* columns,
                         uint64_t mask) {
  static uint32_t list[QUERIES * IDS];
  static size_t offsets[QUERIES + 1];
  size_t q;
  size_t id;
  size_t i;
  size_t count = 0;
  size_t total = 0;
  memset(&got, 0, sizeof(got));
  CHECK_OK(hs_broad_phase_for_each(bodies, HS_SHAPE_BOUND, columns, mask,
                                   take_body, &got));
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      const int expected =
          its.has[id] && is_in_mask(id, mask) &&
          survives(its.kind, bound_of(id), queries + q * its.values);
      CHECK(got.has[q][id] == expected);
      count += (size_t)expected;
    }
  }
  CHECK(count > 10);
  CHECK_OK(hs_broad_phase_query(bodies, HS_SHAPE_BOUND, columns, mask, list, 7,
                                NULL, &total));
  CHECK(total == count);
  CHECK_OK(hs_broad_phase_query(bodies, HS_SHAPE_BOUND, columns, mask, list,
                                QUERIES * IDS, offsets, &total));
  CHECK(total == count && offsets[0] == 0 && offsets[QUERIES] == count);
  for (q = 0; q < QUERIES; ++q) {
    for (i = offsets[q]; i < offsets[q + 1]; ++i) {
      CHECK(got.has[q][list[i]]);
      got.has[q][list[i]] = 0;
    }
  }
  memset(&got, 0, sizeof(got));
  got.stop_after = 3;
  CHECK_OK(hs_broad_phase_for_each(bodies, HS_SHAPE_BOUND, columns, mask,
                                   take_body, &got));
  CHECK(got.calls == 3);
}

// The distance of a point from the box of a body.
static double distance_to(size_t id, const float* point) {
  const size_t dims = dims_of(its.kind);
  const float* const bound = bound_of(id);
  double sum = 0;
  size_t k;
  for (k = 0; k < dims; ++k) {
    const double below = (double)bound[k] - (double)point[k];
    const double above = (double)point[k] - (double)bound[its.values / 2 + k];
    const double gap = fmax(0, fmax(below, above));
    sum += gap * gap;
  }
  return sqrt(sum);
}

static void check_shapes(const float* queries) {
  const size_t dims = dims_of(its.kind);
  static float spheres[QUERIES * 4];
  static float points[QUERIES * VALUES];
  hs_columns columns = hs_float_rows(queries, QUERIES, its.values);
  size_t q;
  size_t id;
  size_t k;
  size_t count = 0;
  CHECK_OK(hs_bound_points(its.kind, &columns, NULL, points, NULL));
  memset(&got, 0, sizeof(got));
  CHECK_OK(hs_broad_phase_for_each(bodies, HS_SHAPE_POINT, &columns, ALL,
                                   take_body, &got));
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(got.has[q][id] ==
            (its.has[id] &&
             survives(its.kind, bound_of(id), points + q * its.values)));
      count += got.has[q][id];
    }
  }
  CHECK(count > 0);

  for (q = 0; q < QUERIES; ++q) {
    float* const sphere = spheres + q * (dims + 1);
    for (k = 0; k < dims; ++k) sphere[k] = queries[q * its.values + k];
    sphere[dims] = 0.1f;
  }
  columns = hs_float_rows(spheres, QUERIES, dims + 1);
  memset(&got, 0, sizeof(got));
  CHECK_OK(hs_broad_phase_for_each(bodies, HS_SHAPE_SPHERE, &columns, ALL,
                                   take_body, &got));
  count = 0;
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      const double distance = distance_to(id, spheres + q * (dims + 1));
      if (!its.has[id]) {
        CHECK(!got.has[q][id]);
      } else if (its.values == 2 * dims && distance <= 0.1) {
        CHECK(got.has[q][id]);
      } else if (distance > 0.1001) {
        CHECK(!got.has[q][id]);
      }
      count += got.has[q][id];
    }
  }
  CHECK(count > 10);
}

typedef struct hits {
  const uint32_t* ids;
  float (*ts)[IDS];
} hits;

static float take_hit_of_bvh(void* context, size_t ray, uint32_t id, float t) {
  const hits* const of = context;
  of->ts[ray][of->ids[id]] = t;
  return INFINITY;
}

// Rays find what they find in a BVH of the same bounds. A box that does not
// move finds what it overlaps.
static void check_casts(void) {
  static float expected[QUERIES][IDS];
  static float rays[QUERIES * 7];
  static float motions[QUERIES * 4];
  static float boxes[QUERIES * 6];
  static float records[IDS * VALUES];
  static uint32_t ids[IDS];
  uint32_t first[QUERIES];
  float ts[QUERIES];
  const size_t dims = dims_of(its.kind);
  const hs_bvh_config config = bvh_config_of(its.kind);
  const hs_kind box_kind = dims == 2 ? HS_BOX2 : HS_BOX3;
  hs_columns columns;
  hs_columns moves = hs_float_rows(motions, QUERIES, dims + 1);
  hits of = {ids, expected};
  hs_bvh* bvh = NULL;
  uint32_t state = 5;
  size_t size = 0;
  size_t count = 0;
  size_t q;
  size_t id;
  size_t k;
  for (id = 0; id < IDS; ++id) {
    if (!its.has[id]) continue;
    memcpy(records + size * its.values, bound_of(id),
           its.values * sizeof(float));
    ids[size++] = (uint32_t)id;
  }
  columns = hs_float_rows(records, size, its.values);
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  for (q = 0; q < QUERIES; ++q) {
    float* const ray = rays + q * (2 * dims + 1);
    for (k = 0; k < dims; ++k) {
      ray[k] = random_float(&state);
      ray[dims + k] = random_float(&state) - 0.5f;
    }
    ray[2 * dims] = q % 2 == 0 ? 1.0f : INFINITY;
    memcpy(motions + q * (dims + 1), ray + dims, (dims + 1) * sizeof(float));
    for (id = 0; id < IDS; ++id) expected[q][id] = -1;
  }
  columns = hs_float_rows(rays, QUERIES, 2 * dims + 1);
  CHECK_OK(hs_bvh_raycast_each(bvh, &columns, 0, NULL, take_hit_of_bvh, &of));
  memset(&got, 0, sizeof(got));
  CHECK_OK(hs_broad_phase_for_each_cast(bodies, HS_SHAPE_POINT, &columns,
                                        &moves, ALL, take_hit, &got));
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(got.has[q][id] == (expected[q][id] >= 0));
      CHECK(!got.has[q][id] || got.ts[q][id] == expected[q][id]);
      count += got.has[q][id];
    }
  }
  CHECK(count > 10);
  hs_bvh_destroy(bvh);
  CHECK_OK(hs_broad_phase_cast(bodies, HS_SHAPE_POINT, &columns, &moves, ALL,
                               first, ts));
  for (q = 0; q < QUERIES; ++q) {
    uint32_t least = HS_NO_ID;
    float t = INFINITY;
    for (id = 0; id < IDS; ++id) {
      if (!got.has[q][id] || got.ts[q][id] >= t) continue;
      least = (uint32_t)id;
      t = got.ts[q][id];
    }
    CHECK(first[q] == least && ts[q] == t);
  }
  memset(first, 0, sizeof(first));
  CHECK_OK(hs_broad_phase_cast(bodies, HS_SHAPE_POINT, &columns, &moves, 0,
                               first, NULL));
  CHECK(first[0] == HS_NO_ID && first[QUERIES - 1] == HS_NO_ID);

  // A cast ends, and the next one begins.
  memset(&got, 0, sizeof(got));
  got.stop_after = 1;
  CHECK_OK(hs_broad_phase_for_each_cast(bodies, HS_SHAPE_POINT, &columns,
                                        &moves, 4, take_hit, &got));
  for (q = 0, count = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(!got.has[q][id] || (its.masks[id].category & 4) != 0);
      count += got.has[q][id] && q == 0;
    }
  }
  CHECK(got.calls > 1 && count <= 1);

  random_bounds(box_kind, QUERIES, 0.1f, 31, boxes);
  memset(motions, 0, sizeof(motions));
  columns = hs_float_rows(boxes, QUERIES, 2 * dims);
  memset(&got, 0, sizeof(got));
  CHECK_OK(hs_broad_phase_for_each_cast(bodies, HS_SHAPE_BOX, &columns, &moves,
                                        ALL, take_hit, &got));
  CHECK(got.calls > 10);
  for (q = 0; q < QUERIES && its.kind == box_kind; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(got.has[q][id] == (its.has[id] && survives(its.kind, bound_of(id),
                                                       boxes + q * 2 * dims)));
      CHECK(got.ts[q][id] == 0);
    }
  }
}

static int keep_no_sevens(void* context, uint32_t a, uint32_t b,
                          int masks_match) {
  CHECK(context == &its && a != b);
  return a % 7 == 0 || b % 7 == 0 ? 0 : masks_match;
}

// Without masks.
static int is_near(size_t a, size_t b, float margin) {
  const float* const of_a = bound_of(a);
  const float* const of_b = bound_of(b);
  const size_t axes = its.values / 2;
  const size_t dims = dims_of(its.kind);
  size_t k;
  if (a == b || !its.has[a] || !its.has[b]) return 0;
  if (!keep_no_sevens(&its, (uint32_t)a, (uint32_t)b, 1)) return 0;
  for (k = 0; k < axes; ++k) {
    const double far = (k < dims ? 1 : (double)dims) * (double)margin;
    if ((double)of_a[k] - (double)of_b[axes + k] > far) return 0;
    if ((double)of_b[k] - (double)of_a[axes + k] > far) return 0;
  }
  return 1;
}

static int is_pair(size_t a, size_t b, float margin) {
  return (its.masks[a].category & its.masks[b].collides_with) != 0 &&
         (its.masks[b].category & its.masks[a].collides_with) != 0 &&
         is_near(a, b, margin);
}

// `a` is of the set, whose ids are below `set`.
typedef struct pairs {
  size_t set;
  size_t calls;
  size_t stop_after;
  float margin;
} pairs;

static hs_visit take_pair(void* context, uint32_t a, uint32_t b) {
  pairs* const of = context;
  CHECK(a < of->set && is_pair(a, b, of->margin));
  return ++of->calls == of->stop_after ? HS_STOP : HS_CONTINUE;
}

static hs_visit count_pair(void* context, uint32_t a, uint32_t b) {
  CHECK(a != b);
  ++((pairs*)context)->calls;
  return HS_CONTINUE;
}

static uint32_t last_a;
static uint32_t last_b;
static int has_begun;

static void take_event(int is_begin, uint32_t a, uint32_t b) {
  CHECK(a < b && its.pairs[a][b] == !is_begin);
  CHECK(is_pair(a, b, 0) == is_begin);
  CHECK(is_begin >= has_begun);
  if (is_begin == has_begun) {
    CHECK(a > last_a || (a == last_a && b > last_b));
  }
  has_begun = is_begin;
  last_a = a;
  last_b = b;
  its.pairs[a][b] = (unsigned char)is_begin;
}
static void begin_pair(void* context, uint32_t a, uint32_t b) {
  CHECK(context == &its);
  take_event(1, a, b);
}
static void end_pair(void* context, uint32_t a, uint32_t b) {
  CHECK(context == &its);
  take_event(0, a, b);
}

static void run_parts(void* context, size_t count, hs_part_function part,
                      void* work) {
  size_t i;
  ++*(size_t*)context;
  for (i = 0; i < count; ++i) part(work, i);
}

static void check_pairs(void) {
  static uint32_t set[IDS];
  pairs of = {0, 0, 0, 0.01f};
  hs_update_options options;
  size_t runs = 0;
  hs_body_statistics statistics;
  size_t a;
  size_t b;
  size_t count = 0;
  size_t in_set = 0;
  for (a = 0; a < IDS / 3; ++a) {
    if (its.has[a]) set[count++] = (uint32_t)a;
  }
  of.set = IDS / 3;
  CHECK_OK(hs_broad_phase_for_each_pair_of(bodies, set, NULL, count, of.margin,
                                           take_pair, &of));
  for (a = 0; a < of.set; ++a) {
    for (b = 0; b < IDS; ++b) {
      // A pair of two bodies of the set once.
      if (b < of.set && b < a) continue;
      in_set += (size_t)is_pair(a, b, of.margin);
    }
  }
  CHECK(of.calls == in_set && in_set > 10);
  of.calls = 0;
  of.stop_after = 2;
  CHECK_OK(hs_broad_phase_for_each_pair_of(bodies, set, NULL, count, of.margin,
                                           take_pair, &of));
  CHECK(of.calls == 2);

  // With masks of the call.
  {
    static uint64_t masks[IDS];
    pairs all = {IDS, 0, 0, -1};
    size_t expected = 0;
    for (a = 0; a < IDS; ++a) masks[a] = 2;
    for (a = 0; a < of.set; ++a) {
      for (b = 0; b < IDS; ++b) {
        const int is_found = (its.masks[b].category & 2) != 0;
        if (b >= of.set) expected += is_found && is_near(a, b, 0);
        if (b < of.set && b > a) {
          expected += (is_found || (its.masks[a].category & 2) != 0) &&
                      is_near(a, b, 0);
        }
      }
    }
    CHECK_OK(hs_broad_phase_for_each_pair_of(bodies, set, masks, count, 0,
                                             count_pair, &all));
    CHECK(all.calls == expected && expected > 0);
  }

  last_a = last_b = 0;
  has_begun = 0;
  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  options.run = run_parts;
  options.run_context = &runs;
  CHECK_OK(hs_broad_phase_update_pairs(bodies, &options, begin_pair, end_pair,
                                       &its));
  for (a = 0, count = 0; a < IDS; ++a) {
    for (b = a + 1; b < IDS; ++b) {
      CHECK(its.pairs[a][b] == is_pair(a, b, 0));
      count += its.pairs[a][b];
    }
  }
  CHECK_OK(hs_broad_phase_statistics(bodies, &statistics, sizeof(statistics)));
  CHECK(statistics.pairs == count && count > 10);
}

static void check_all(uint32_t seed) {
  static float queries[QUERIES * VALUES];
  static double doubles[QUERIES * 9];
  static uint32_t ids[IDS];
  static float records[IDS * VALUES];
  static hs_body_masks masks[IDS];
  float around[VALUES];
  hs_columns columns = hs_float_rows(queries, QUERIES, its.values);
  hs_body_statistics statistics;
  size_t size = 0;
  size_t count = 0;
  size_t i;
  size_t v;
  int is_valid = 0;
  random_bounds(its.kind, QUERIES, 0.2f, seed, queries);
  check_bounds(queries, &columns, ALL);
  check_bounds(queries, &columns, 2);
  // The same in doubles, which are not rows.
  columns = hs_double_rows(doubles, QUERIES, 9);
  for (i = 0; i < QUERIES; ++i) {
    for (v = 0; v < its.values; ++v) {
      doubles[i * 9 + v] = (double)queries[i * its.values + v];
    }
  }
  check_bounds(queries, &columns, ALL);
  check_shapes(queries);
  check_casts();
  check_pairs();

  CHECK_OK(hs_broad_phase_size(bodies, &size));
  CHECK_OK(hs_broad_phase_bounds(bodies, around));
  for (i = 0; i < IDS; ++i) {
    int has = 2;
    CHECK_OK(hs_broad_phase_has(bodies, (uint32_t)i, &has));
    CHECK(has == its.has[i]);
    if (!has) continue;
    ids[count++] = (uint32_t)i;
    for (v = 0; v < its.values / 2; ++v) {
      CHECK(around[v] <= bound_of(i)[v]);
      CHECK(around[its.values / 2 + v] >= bound_of(i)[its.values / 2 + v]);
    }
  }
  CHECK(count == size);
  CHECK_OK(hs_broad_phase_get(bodies, ids, count, records, masks));
  for (i = 0; i < count; ++i) {
    CHECK(memcmp(records + i * its.values, bound_of(ids[i]),
                 its.values * sizeof(float)) == 0);
    CHECK(masks[i].category == its.masks[ids[i]].category);
    CHECK(masks[i].collides_with == its.masks[ids[i]].collides_with);
  }
  CHECK_OK(hs_broad_phase_validate(bodies, &is_valid));
  CHECK(is_valid == 1);
  CHECK_OK(hs_broad_phase_statistics(bodies, &statistics, sizeof(statistics)));
  CHECK(statistics.bodies == size && statistics.trees >= 1);
  CHECK(statistics.bytes > size * its.values * sizeof(float));
  CHECK(statistics.cost_ratio >= 1);
}

// Gives every third body from `first` on another bound: half of them in rows of
// floats, and half in columns of doubles that are no rows.
static void change(int is_new, size_t first, uint32_t seed) {
  static uint32_t ids[IDS];
  static float rows[IDS * VALUES];
  static double doubles[IDS * 9];
  static hs_body_masks masks[IDS];
  hs_columns columns;
  size_t count = 0;
  size_t half;
  size_t i;
  size_t v;
  random_bounds(its.kind, IDS / 3, dims_of(its.kind) == 2 ? 0.02f : 0.1f, seed,
                rows);
  for (i = first; i < IDS; i += 3) {
    its.has[i] = 1;
    memcpy(its.bounds + i * its.values, rows + count * its.values,
           its.values * sizeof(float));
    for (v = 0; v < its.values; ++v) {
      doubles[count * 9 + v] = (double)rows[count * its.values + v];
    }
    if (is_new) {
      its.masks[i].category = (uint64_t)1 << (i % 5);
      its.masks[i].collides_with = i % 4 == 0 ? 3 : ALL;
    }
    masks[count] = its.masks[i];
    ids[count++] = (uint32_t)i;
  }
  half = count / 2;
  columns = hs_float_rows(rows, half, its.values);
  if (is_new) {
    CHECK_OK(hs_broad_phase_insert(bodies, ids, &columns, masks));
    columns = hs_double_rows(doubles + half * 9, count - half, 9);
    CHECK_OK(hs_broad_phase_insert(bodies, ids + half, &columns, masks + half));
  } else {
    CHECK_OK(hs_broad_phase_move(bodies, ids, &columns));
    columns = hs_double_rows(doubles + half * 9, count - half, 9);
    CHECK_OK(hs_broad_phase_move(bodies, ids + half, &columns));
  }
}

static void erase(size_t first, size_t step) {
  static uint32_t ids[IDS];
  size_t count = 0;
  size_t i;
  for (i = first; i < IDS; i += step) {
    if (its.has[i]) ids[count++] = (uint32_t)i;
    its.has[i] = 0;
  }
  CHECK_OK(hs_broad_phase_erase(bodies, ids, count));
}

static void test_history(hs_kind kind) {
  hs_broad_phase_config config = config_of(kind);
  hs_update_options options;
  size_t runs = 0;
  uint32_t id = 4;
  int has = 1;
  memset(&its, 0, sizeof(its));
  its.kind = kind;
  its.values = hs_bound_values(kind);
  config.margin = 0.01f;
  config.keep = keep_no_sevens;
  config.keep_context = &its;
  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  CHECK(options.budget == SIZE_MAX);
  options.run = run_parts;
  options.run_context = &runs;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_has(bodies, IDS + 5, &has));
  CHECK(has == 0);
  change(1, 0, 41);
  change(1, 1, 42);
  check_all(43);
  change(0, 1, 44);
  erase(3, 9);
  check_all(45);
  CHECK_OK(hs_broad_phase_update(bodies, NULL));
  check_all(46);
  its.masks[id].category = 8;
  its.masks[id].collides_with = 2;
  CHECK_OK(hs_broad_phase_set_masks(bodies, &id, &its.masks[id], 1));
  change(1, 2, 47);
  change(0, 1, 48);
  CHECK_OK(hs_broad_phase_rebuild(bodies, &options));
  CHECK(runs > 0);
  CHECK_OK(hs_broad_phase_update(bodies, &options));
  check_all(49);
  hs_broad_phase_destroy(bodies);
}

// A callback changes the bodies, and its query goes on.
static hs_visit move_away(void* context, size_t query, uint32_t id,
                          const float* bound) {
  const float far[] = {9, 9, 9, 9};
  const hs_columns columns = hs_float_rows(far, 1, 4);
  size_t* const calls = context;
  CHECK(query == 0 && bound[2] == 1);
  ++*calls;
  CHECK_OK(hs_broad_phase_move(bodies, &id, &columns));
  CHECK_OK(hs_broad_phase_update(bodies, NULL));
  CHECK_OK(hs_broad_phase_erase(bodies, &id, 1));
  return HS_CONTINUE;
}

static void count_event(void* context, uint32_t a, uint32_t b) {
  const uint32_t gone[] = {a};
  (void)b;
  ++*(size_t*)context;
  (void)hs_broad_phase_erase(bodies, gone, 1);
}

static void test_callbacks(void) {
  const float boxes[] = {0, 0, 1, 1};
  const uint32_t ids[] = {0, 1, 2};
  const hs_broad_phase_config config = config_of(HS_BOX2);
  hs_columns columns = hs_float_rows(boxes, 3, 4);
  hs_body_masks masks[3];
  size_t calls = 0;
  size_t size = 0;
  columns.stride = 0;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &columns, NULL));
  CHECK_OK(hs_broad_phase_get(bodies, ids, 3, NULL, masks));
  CHECK(masks[2].category == 1 && masks[2].collides_with == ALL);
  // The pairs (0, 1), (0, 2) and (1, 2) end with the bodies.
  CHECK_OK(hs_broad_phase_update_pairs(bodies, NULL, count_event, count_event,
                                       &calls));
  CHECK(calls == 3);
  CHECK_OK(hs_broad_phase_size(bodies, &size));
  CHECK(size == 1);
  CHECK_OK(hs_broad_phase_update_pairs(bodies, NULL, count_event, count_event,
                                       &calls));
  CHECK(calls == 6);
  columns.count = 1;
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &columns, NULL));
  calls = 0;
  CHECK_OK(hs_broad_phase_for_each(bodies, HS_SHAPE_BOUND, &columns, ALL,
                                   move_away, &calls));
  CHECK(calls == 2);
  CHECK_OK(hs_broad_phase_size(bodies, &size));
  CHECK(size == 0);
  hs_broad_phase_destroy(bodies);
  hs_broad_phase_destroy(NULL);
}

static float take_t(void* context, size_t cast, uint32_t id, float t,
                    const float* bound) {
  CHECK(cast == 0 && id == 0 && bound[0] == 4);
  *(float*)context = t;
  return INFINITY;
}

static void test_sphere_cast(void) {
  const float box[] = {4, 0, 5, 1};
  const float sphere[] = {0, 0.5f, 1};
  const float motion[] = {2, 0, 10};
  const uint32_t id = 0;
  const hs_broad_phase_config config = config_of(HS_BOX2);
  const hs_columns columns = hs_float_rows(box, 1, 4);
  const hs_columns starts = hs_float_rows(sphere, 1, 3);
  const hs_columns motions = hs_float_rows(motion, 1, 3);
  float t = 0;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, &id, &columns, NULL));
  CHECK_OK(hs_broad_phase_for_each_cast(bodies, HS_SHAPE_SPHERE, &starts,
                                        &motions, ALL, take_t, &t));
  CHECK(t <= 1.5f && t > 1.4999f);
  hs_broad_phase_destroy(bodies);
}

static void test_errors_of_bodies(void) {
  const float boxes[] = {0, 0, 1, 1, 2, 2, 3, 3};
  const double doubles[] = {0, 0, 1};
  const float motion[] = {1, 0, -1};
  const uint32_t ids[] = {5, IDS};
  const uint32_t twice[] = {5, 5};
  const hs_body_masks masks[] = {{1, 1}, {1, 1}};
  hs_columns columns = hs_float_rows(boxes, 2, 4);
  hs_columns one = hs_float_rows(boxes, 1, 4);
  hs_columns motions = hs_float_rows(motion, 1, 3);
  hs_broad_phase_config config = config_of(HS_SIMPLEX2);
  hs_update_options options;
  hs_body_statistics statistics;
  float record[4];
  size_t size = 0;
  bodies = NULL;
  CHECK_INVALID(hs_broad_phase_create(&config, &bodies),
                "hs_broad_phase_create: config->kind: expected boxes or "
                "octahedra, got simplices, which have no planes that face each "
                "other");
  config.kind = (hs_kind)7;
  CHECK_INVALID(hs_broad_phase_create(&config, &bodies),
                "hs_broad_phase_create: config->kind: expected an enumerator "
                "of hs_kind, got 7");
  config.kind = HS_BOX2;
  config.margin = NAN;
  CHECK_INVALID(hs_broad_phase_create(&config, &bodies),
                "hs_broad_phase_create: config->margin: expected a finite "
                "number that is not negative, got nan");
  config.margin = 0;
  config.max_ids = ((size_t)1 << 29) + 1;
  CHECK_INVALID(hs_broad_phase_create(&config, &bodies),
                "hs_broad_phase_create: config->max_ids: expected at most 2^29 "
                "ids, got 536870913");
  CHECK_INVALID(hs_broad_phase_create(NULL, &bodies),
                "hs_broad_phase_create: config: expected a pointer, got null");
  config.max_ids = IDS;
  CHECK(bodies == NULL);
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_INVALID(hs_broad_phase_insert(bodies, ids, &columns, NULL),
                "hs_broad_phase_insert: ids[1]: expected an id below max_ids, "
                "900, got 900");
  CHECK_INVALID(hs_broad_phase_insert(bodies, twice, &columns, masks),
                "hs_broad_phase_insert: ids[1]: expected an id that no body "
                "has, once in the list, got 5");
  CHECK_INVALID(hs_broad_phase_insert(bodies, NULL, &columns, NULL),
                "hs_broad_phase_insert: ids: expected a pointer, got null");
  CHECK_OK(hs_broad_phase_size(bodies, &size));
  CHECK(size == 0);
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &one, NULL));
  CHECK_INVALID(
      hs_broad_phase_move(bodies, ids, &columns),
      "hs_broad_phase_move: ids[1]: expected the id of a body, got 900");
  CHECK_INVALID(
      hs_broad_phase_erase(bodies, ids, 2),
      "hs_broad_phase_erase: ids[1]: expected the id of a body, got 900");
  CHECK_INVALID(
      hs_broad_phase_set_masks(bodies, ids, masks, 2),
      "hs_broad_phase_set_masks: ids[1]: expected the id of a body, got 900");
  CHECK_INVALID(
      hs_broad_phase_set_masks(bodies, ids, NULL, 1),
      "hs_broad_phase_set_masks: masks: expected a pointer, got null");
  CHECK_INVALID(
      hs_broad_phase_get(bodies, ids, 2, NULL, NULL),
      "hs_broad_phase_get: ids[1]: expected the id of a body, got 900");
  CHECK_INVALID(
      hs_broad_phase_for_each(bodies, HS_SHAPE_BOX, &one, ALL, take_body, &got),
      "hs_broad_phase_for_each: shape: expected HS_SHAPE_BOUND, "
      "HS_SHAPE_POINT or HS_SHAPE_SPHERE, got 1");
  CHECK_INVALID(
      hs_broad_phase_for_each(bodies, HS_SHAPE_BOUND, &one, ALL, NULL, NULL),
      "hs_broad_phase_for_each: function: expected a pointer, got "
      "null");
  one = hs_double_rows(doubles, 1, 3);
  CHECK_INVALID(hs_broad_phase_for_each(bodies, HS_SHAPE_SPHERE, &one, ALL,
                                        take_body, &got),
                "hs_broad_phase_for_each: queries->type: expected HS_FLOAT32, "
                "as these cannot be rounded outward, got HS_FLOAT64");
  CHECK_INVALID(hs_broad_phase_for_each(bodies, HS_SHAPE_SPHERE, &motions, ALL,
                                        take_body, &got),
                "hs_broad_phase_for_each: radius: expected a number that is "
                "not negative, got -1");
  one = hs_float_rows(boxes, 1, 4);
  CHECK_INVALID(hs_broad_phase_for_each_cast(bodies, HS_SHAPE_BOUND, &one,
                                             &motions, ALL, take_hit, &got),
                "hs_broad_phase_for_each_cast: shape: expected HS_SHAPE_BOX, "
                "HS_SHAPE_POINT or HS_SHAPE_SPHERE, got 0");
  CHECK_INVALID(
      hs_broad_phase_for_each_cast(bodies, HS_SHAPE_SPHERE, &motions, &one, ALL,
                                   take_hit, &got),
      "hs_broad_phase_for_each_cast: starts->column[2]: expected radii that "
      "are not negative, got -1 of sphere 0");
  CHECK_INVALID(
      hs_broad_phase_for_each_cast(bodies, HS_SHAPE_POINT, &one, &motions, ALL,
                                   take_hit, &got),
      "hs_broad_phase_for_each_cast: motions->column[2]: expected limits of t "
      "that are not negative, got -1 of motion 0");
  CHECK_INVALID(
      hs_broad_phase_for_each_cast(bodies, HS_SHAPE_BOX, &columns, &motions,
                                   ALL, take_hit, &got),
      "hs_broad_phase_for_each_cast: motions->count: expected one for each of "
      "2 starts, got 1");
  CHECK_INVALID(hs_broad_phase_cast(bodies, HS_SHAPE_POINT, &one, &motions, ALL,
                                    NULL, NULL),
                "hs_broad_phase_cast: ids: expected a pointer, got null");
  CHECK_INVALID(hs_broad_phase_query(bodies, HS_SHAPE_BOX, &one, ALL, NULL, 0,
                                     NULL, &size),
                "hs_broad_phase_query: shape: expected HS_SHAPE_BOUND, "
                "HS_SHAPE_POINT or HS_SHAPE_SPHERE, got 1");
  motions = hs_double_rows(doubles, 1, 3);
  CHECK_INVALID(
      hs_broad_phase_for_each_cast(bodies, HS_SHAPE_BOX, &one, &motions, ALL,
                                   take_hit, &got),
      "hs_broad_phase_for_each_cast: motions->type: expected HS_FLOAT32, as "
      "these cannot be rounded outward, got HS_FLOAT64");
  CHECK_INVALID(
      hs_broad_phase_for_each_pair_of(bodies, ids, NULL, 2, 0, take_pair, NULL),
      "hs_broad_phase_for_each_pair_of: ids[1]: expected the id of a body, got "
      "900");
  CHECK_INVALID(
      hs_broad_phase_for_each_pair_of(bodies, ids, NULL, 1, -1, take_pair,
                                      NULL),
      "hs_broad_phase_for_each_pair_of: margin: expected a finite number that "
      "is not negative, got -1");
  CHECK_INVALID(
      hs_broad_phase_update_pairs(bodies, NULL, begin_pair, NULL, NULL),
      "hs_broad_phase_update_pairs: ended: expected a pointer, got null");
  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  options.struct_size = 3;
  CHECK_INVALID(hs_broad_phase_update(bodies, &options),
                "hs_broad_phase_update: options->struct_size: expected sizeof "
                "*options, as the function ..._default() sets it, got 3");
  CHECK_INVALID(hs_broad_phase_statistics(bodies, &statistics, 3),
                "hs_broad_phase_statistics: struct_size: expected the sizeof "
                "of the struct, got 3");
  CHECK_INVALID(hs_broad_phase_validate(NULL, NULL),
                "hs_broad_phase_validate: bodies: expected a pointer, got "
                "null");
  CHECK_OK(hs_broad_phase_get(bodies, ids, 1, record, NULL));
  CHECK(memcmp(record, boxes, sizeof(record)) == 0);
  hs_broad_phase_destroy(bodies);
}

void test_broad_phase(void) {
  int kind;
  for (kind = 0; kind < KINDS; ++kind) {
    if (!is_simplex(kind_of(kind))) test_history(kind_of(kind));
  }
  test_callbacks();
  test_sphere_cast();
  test_errors_of_bodies();
}
