// The broad phase against every body, and against a hierarchy of them.
#include <math.h>
#include <stdlib.h>

#include "check.h"

enum { IDS = 900, QUERIES = 60, VALUES = 8 };
#define ALL UINT32_MAX

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
// Of the same bounds and masks. Object i is body bvh_ids[i].
static hs_bvh* bvh;
static uint32_t bvh_ids[IDS];

static hs_broad_phase_config config_of(hs_kind kind) {
  hs_broad_phase_config config;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = kind;
  return config;
}

static hs_query_options options_of(hs_shape shape, uint32_t mask) {
  hs_query_options options;
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  options.shape = shape;
  options.mask = mask;
  return options;
}

static const float* bound_of(size_t id) { return its.bounds + id * its.values; }

static void make_bvh(void) {
  static float records[IDS * VALUES];
  static uint32_t masks[IDS];
  const hs_bvh_config config = bvh_config_of(its.kind);
  hs_columns columns = hs_float_rows(records, 0, its.values);
  size_t id;
  for (id = 0; id < IDS; ++id) {
    if (!its.has[id]) continue;
    memcpy(records + columns.count * its.values, bound_of(id),
           its.values * sizeof(float));
    masks[columns.count] = its.masks[id].category;
    bvh_ids[columns.count++] = (uint32_t)id;
  }
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_set_all_masks(bvh, masks, columns.count));
}

// What searches found: by body, or by object of the hierarchy.
typedef struct found {
  const uint32_t* ids;  // of objects; null: of bodies
  size_t calls;
  size_t stop_after;
  size_t counts[QUERIES];
  unsigned char has[QUERIES][IDS];
  float ts[QUERIES][IDS];
} found;

static found got;
static found expected;

static void clear(void) {
  memset(&got, 0, sizeof(got));
  memset(&expected, 0, sizeof(expected));
  expected.ids = bvh_ids;
}

static void take(found* to, size_t query, uint32_t id) {
  const uint32_t body = to->ids != NULL ? to->ids[id] : id;
  CHECK(query < QUERIES && body < IDS && its.has[body]);
  CHECK(!to->has[query][body]);
  to->has[query][body] = 1;
  ++to->counts[query];
}

static hs_visit take_ids(void* context, size_t query, const uint32_t* ids,
                         size_t count) {
  found* const to = context;
  size_t i;
  CHECK(count > 0);
  for (i = 0; i < count; ++i) take(to, query, ids[i]);
  return ++to->calls == to->stop_after ? HS_STOP : HS_CONTINUE;
}

static float take_hit(void* context, size_t cast, uint32_t id, float t) {
  found* const to = context;
  take(to, cast, id);
  to->ts[cast][to->ids != NULL ? to->ids[id] : id] = t;
  return ++to->calls == to->stop_after ? -1.0f : INFINITY;
}

static int is_in_mask(size_t id, uint32_t mask) {
  return mask == ALL || (its.masks[id].category & mask) != 0;
}

// Every query of ids returns what got.has says.
static void check_queries(const hs_columns* columns,
                          const hs_query_options* options) {
  static uint32_t list[QUERIES * IDS];
  static size_t offsets[QUERIES + 1];
  size_t counts[QUERIES];
  uint32_t any[QUERIES];
  hs_query_options rest = *options;
  size_t total = 0;
  size_t sum = 0;
  size_t q;
  size_t i;
  CHECK_OK(hs_broad_phase_count(bodies, columns, options, counts));
  CHECK_OK(hs_broad_phase_any(bodies, columns, options, any));
  for (q = 0; q < QUERIES; ++q) {
    CHECK(counts[q] == got.counts[q]);
    CHECK(counts[q] == 0 ? any[q] == HS_NO_ID
                         : any[q] < IDS && got.has[q][any[q]]);
    sum += counts[q];
  }
  CHECK_OK(
      hs_broad_phase_query(bodies, columns, options, list, 7, NULL, &total));
  CHECK(total == sum);
  // The others are written by a second call.
  rest.skip = 7;
  CHECK_OK(hs_broad_phase_query(bodies, columns, &rest, list + 7,
                                QUERIES * IDS - 7, offsets, &total));
  CHECK(total == sum && offsets[0] == 0 && offsets[QUERIES] == sum);
  for (q = 0; q < QUERIES; ++q) {
    for (i = offsets[q]; i < offsets[q + 1]; ++i) {
      CHECK(list[i] < IDS && got.has[q][list[i]] == 1);
      got.has[q][list[i]] = 2;
    }
    CHECK(offsets[q + 1] - offsets[q] == counts[q]);
  }
  clear();
  got.stop_after = 3;
  CHECK_OK(hs_broad_phase_probe(bodies, columns, options, take_ids, &got));
  CHECK(got.calls == 3);
}

static void check_bounds(const float* queries, const hs_columns* columns,
                         uint32_t mask) {
  const hs_query_options options = options_of(HS_SHAPE_BOUND, mask);
  size_t q;
  size_t id;
  size_t count = 0;
  clear();
  CHECK_OK(hs_broad_phase_probe(bodies, columns, &options, take_ids, &got));
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      const int is_found =
          its.has[id] && is_in_mask(id, mask) &&
          survives(its.kind, bound_of(id), queries + q * its.values);
      CHECK(got.has[q][id] == is_found);
      count += (size_t)is_found;
    }
  }
  CHECK(count > 10);
  check_queries(columns, &options);
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
  hs_query_options options = options_of(HS_SHAPE_POINT, ALL);
  hs_columns columns = hs_float_rows(queries, QUERIES, its.values);
  size_t q;
  size_t id;
  size_t k;
  size_t count = 0;
  CHECK_OK(hs_bound_points(its.kind, &columns, NULL, points, NULL));
  clear();
  CHECK_OK(hs_broad_phase_probe(bodies, &columns, &options, take_ids, &got));
  CHECK_OK(hs_bvh_probe(bvh, &columns, &options, take_ids, &expected));
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(got.has[q][id] ==
            (its.has[id] &&
             survives(its.kind, bound_of(id), points + q * its.values)));
      CHECK(got.has[q][id] == expected.has[q][id]);
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
  options.shape = HS_SHAPE_SPHERE;
  clear();
  CHECK_OK(hs_broad_phase_probe(bodies, &columns, &options, take_ids, &got));
  CHECK_OK(hs_bvh_probe(bvh, &columns, &options, take_ids, &expected));
  count = 0;
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      const double distance = distance_to(id, spheres + q * (dims + 1));
      CHECK(got.has[q][id] == expected.has[q][id]);
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
  check_queries(&columns, &options);
  {
    size_t of_bvh[QUERIES];
    size_t of_bodies[QUERIES];
    uint32_t any[QUERIES];
    uint32_t any_of_bvh[QUERIES];
    options.mask = 6;
    CHECK_OK(hs_bvh_count(bvh, &columns, &options, of_bvh));
    CHECK_OK(hs_broad_phase_count(bodies, &columns, &options, of_bodies));
    CHECK_OK(hs_bvh_any(bvh, &columns, &options, any_of_bvh));
    CHECK_OK(hs_broad_phase_any(bodies, &columns, &options, any));
    for (q = 0, count = 0; q < QUERIES; ++q) {
      CHECK(of_bvh[q] == of_bodies[q]);
      CHECK((any[q] == HS_NO_ID) == (of_bvh[q] == 0));
      CHECK((any_of_bvh[q] == HS_NO_ID) == (of_bvh[q] == 0));
      count += of_bvh[q];
    }
    CHECK(count > 10);
  }
}

static void check_nearest(const float* queries) {
  enum { K = 5 };
  const size_t dims = dims_of(its.kind);
  static float boxes[QUERIES * 6];
  hs_query_options options = options_of(HS_SHAPE_BOUND, ALL);
  hs_columns columns = hs_float_rows(queries, QUERIES, its.values);
  uint32_t ids[QUERIES * K];
  float distances[QUERIES * K];
  float of_bvh[QUERIES * K];
  size_t i;
  CHECK_OK(hs_broad_phase_nearest_to_points(bodies, &columns, K, 0.2f, &options,
                                            ids, distances));
  CHECK_OK(
      hs_bvh_nearest_to_points(bvh, &columns, K, 0.2f, &options, ids, of_bvh));
  CHECK(memcmp(distances, of_bvh, sizeof(distances)) == 0);
  CHECK_OK(hs_broad_phase_nearest_to_points(bodies, &columns, K, 0.2f, &options,
                                            ids, NULL));
  for (i = 0; i < QUERIES * K; ++i) {
    CHECK((ids[i] == HS_NO_ID) == (distances[i] == INFINITY));
    if (ids[i] == HS_NO_ID) continue;
    CHECK(its.has[ids[i]]);
    CHECK(fabs(distance_to(ids[i], queries + i / K * its.values) -
               (double)distances[i]) < 1e-5);
  }
  CHECK(ids[0] != HS_NO_ID);

  random_bounds(dims == 2 ? HS_BOX2 : HS_BOX3, QUERIES, 0.1f, 33, boxes);
  columns = hs_float_rows(boxes, QUERIES, 2 * dims);
  options.mask = 6;
  CHECK_OK(hs_broad_phase_nearest_to_boxes(bodies, &columns, K, INFINITY,
                                           &options, ids, distances));
  for (i = 0; i < QUERIES * K; ++i) {
    CHECK(ids[i] < IDS && is_in_mask(ids[i], 6));
    CHECK(i % K == 0 || distances[i - 1] <= distances[i]);
  }
  CHECK_OK(hs_bvh_nearest_to_boxes(bvh, &columns, K, INFINITY, &options, ids,
                                   of_bvh));
  CHECK(memcmp(distances, of_bvh, sizeof(distances)) == 0);
}

// The casts of one kind. `starts` of rays have their motions.
typedef struct casts {
  hs_status (*of_bvh)(const hs_columns* starts, const hs_query_options* options,
                      void* context);
  hs_status (*of_bodies)(const hs_columns* starts,
                         const hs_query_options* options, void* context);
  hs_status (*first)(const hs_columns* starts, const hs_query_options* options,
                     uint32_t* ids, float* ts);
} casts;

static hs_columns motions_of_casts;

static hs_status rays_of_bvh(const hs_columns* starts,
                             const hs_query_options* options, void* context) {
  return hs_bvh_raycast_each(bvh, starts, 0.01f, options, take_hit, context);
}
static hs_status rays_of_bodies(const hs_columns* starts,
                                const hs_query_options* options,
                                void* context) {
  return hs_broad_phase_raycast_each(bodies, starts, 0.01f, options, take_hit,
                                     context);
}
static hs_status first_of_rays(const hs_columns* starts,
                               const hs_query_options* options, uint32_t* ids,
                               float* ts) {
  return hs_broad_phase_raycast(bodies, starts, 0.01f, options, ids, ts);
}
static hs_status boxes_of_bvh(const hs_columns* starts,
                              const hs_query_options* options, void* context) {
  return hs_bvh_boxcast_each(bvh, starts, &motions_of_casts, options, take_hit,
                             context);
}
static hs_status boxes_of_bodies(const hs_columns* starts,
                                 const hs_query_options* options,
                                 void* context) {
  return hs_broad_phase_boxcast_each(bodies, starts, &motions_of_casts, options,
                                     take_hit, context);
}
static hs_status first_of_boxes(const hs_columns* starts,
                                const hs_query_options* options, uint32_t* ids,
                                float* ts) {
  return hs_broad_phase_boxcast(bodies, starts, &motions_of_casts, options, ids,
                                ts);
}
static hs_status spheres_of_bvh(const hs_columns* starts,
                                const hs_query_options* options,
                                void* context) {
  return hs_bvh_spherecast_each(bvh, starts, &motions_of_casts, options,
                                take_hit, context);
}
static hs_status spheres_of_bodies(const hs_columns* starts,
                                   const hs_query_options* options,
                                   void* context) {
  return hs_broad_phase_spherecast_each(bodies, starts, &motions_of_casts,
                                        options, take_hit, context);
}
static hs_status first_of_spheres(const hs_columns* starts,
                                  const hs_query_options* options,
                                  uint32_t* ids, float* ts) {
  return hs_broad_phase_spherecast(bodies, starts, &motions_of_casts, options,
                                   ids, ts);
}

// They find what they find in the hierarchy.
static void check_casts_of(const casts* of, const hs_columns* starts) {
  uint32_t first[QUERIES];
  float ts[QUERIES];
  hs_query_options options = options_of(HS_SHAPE_BOUND, ALL);
  size_t count = 0;
  size_t q;
  size_t id;
  clear();
  CHECK_OK(of->of_bvh(starts, &options, &expected));
  CHECK_OK(of->of_bodies(starts, &options, &got));
  CHECK(memcmp(got.has, expected.has, sizeof(got.has)) == 0);
  CHECK(memcmp(got.ts, expected.ts, sizeof(got.ts)) == 0);
  CHECK(got.calls > 10);
  CHECK_OK(of->first(starts, &options, first, ts));
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
  options.mask = 0;
  memset(first, 0, sizeof(first));
  CHECK_OK(of->first(starts, &options, first, NULL));
  CHECK(first[0] == HS_NO_ID && first[QUERIES - 1] == HS_NO_ID);

  // A cast ends, and the next one begins.
  options.mask = 4;
  clear();
  got.stop_after = 1;
  CHECK_OK(of->of_bodies(starts, &options, &got));
  for (q = 0; q < QUERIES; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(!got.has[q][id] || is_in_mask(id, 4));
      count += got.has[q][id] && q == 0;
    }
  }
  CHECK(got.calls > 1 && count <= 1);
}

static void check_casts(void) {
  const casts rays = {rays_of_bvh, rays_of_bodies, first_of_rays};
  const casts box_casts = {boxes_of_bvh, boxes_of_bodies, first_of_boxes};
  const casts spheres = {spheres_of_bvh, spheres_of_bodies, first_of_spheres};
  static float starts[QUERIES * 7];
  static float motions[QUERIES * 4];
  static double doubles[QUERIES * 7];
  const size_t dims = dims_of(its.kind);
  const hs_kind box_kind = dims == 2 ? HS_BOX2 : HS_BOX3;
  const hs_query_options options = options_of(HS_SHAPE_BOUND, ALL);
  hs_columns columns = hs_float_rows(starts, QUERIES, 2 * dims + 1);
  uint32_t state = 5;
  size_t q;
  size_t id;
  size_t k;
  motions_of_casts = hs_float_rows(motions, QUERIES, dims + 1);
  for (q = 0; q < QUERIES; ++q) {
    float* const ray = starts + q * (2 * dims + 1);
    for (k = 0; k < dims; ++k) {
      ray[k] = random_float(&state);
      ray[dims + k] = random_float(&state) - 0.5f;
    }
    ray[2 * dims] = q % 2 == 0 ? 1.0f : INFINITY;
    memcpy(motions + q * (dims + 1), ray + dims, (dims + 1) * sizeof(float));
  }
  check_casts_of(&rays, &columns);
  for (q = 0; q < QUERIES; ++q) {
    for (k = 0; k <= dims; ++k) {
      starts[q * (dims + 1) + k] = random_float(&state) * (k < dims ? 1 : 0.1f);
    }
  }
  columns = hs_float_rows(starts, QUERIES, dims + 1);
  check_casts_of(&spheres, &columns);
  random_bounds(box_kind, QUERIES, 0.1f, 31, starts);
  columns = hs_float_rows(starts, QUERIES, 2 * dims);
  check_casts_of(&box_casts, &columns);
  // The same boxes in doubles, and motions that are no rows.
  for (k = 0; k < QUERIES * 2 * dims; ++k) doubles[k] = (double)starts[k];
  columns = hs_double_rows(doubles, QUERIES, 2 * dims);
  motions_of_casts.stride = 0;
  check_casts_of(&box_casts, &columns);

  // A box that does not move finds what it overlaps.
  memset(motions, 0, sizeof(motions));
  clear();
  CHECK_OK(boxes_of_bodies(&columns, &options, &got));
  CHECK(got.calls > 10);
  for (q = 0; q < QUERIES && its.kind == box_kind; ++q) {
    for (id = 0; id < IDS; ++id) {
      CHECK(got.has[q][id] == (its.has[id] && survives(its.kind, bound_of(id),
                                                       starts + q * 2 * dims)));
      CHECK(got.ts[q][id] == 0);
    }
  }
}

static bool keep_no_sevens(void* context, uint32_t a, uint32_t b,
                           bool masks_match) {
  CHECK(context == &its && a != b);
  return a % 7 == 0 || b % 7 == 0 ? false : masks_match;
}

// Without masks.
static int is_near(size_t a, size_t b, float margin) {
  const float* const of_a = bound_of(a);
  const float* const of_b = bound_of(b);
  const size_t axes = its.values / 2;
  const size_t dims = dims_of(its.kind);
  size_t k;
  if (a == b || !its.has[a] || !its.has[b]) return 0;
  for (k = 0; k < axes; ++k) {
    const double far = (k < dims ? 1 : (double)dims) * (double)margin;
    if ((double)of_a[k] - (double)of_b[axes + k] > far) return 0;
    if ((double)of_b[k] - (double)of_a[axes + k] > far) return 0;
  }
  return 1;
}

static int is_pair(size_t a, size_t b) {
  return keep_no_sevens(
             &its, (uint32_t)a, (uint32_t)(a == b ? a + 1 : b),
             (its.masks[a].category & its.masks[b].collides_with) != 0 &&
                 (its.masks[b].category & its.masks[a].collides_with) != 0) &&
         is_near(a, b, 0);
}

// What a search for the pairs of a set should find: the set has the bodies
// below IDS / 3.
static int is_pair_of(size_t a, size_t b, const hs_pair_options* options) {
  const uint32_t mask = options->mask;
  const uint32_t wanted = options->wanted != NULL ? options->wanted[0] : ALL;
  const int has_a = a < IDS / 3 && is_in_mask(b, wanted);
  const int has_b = b < IDS / 3 && is_in_mask(a, wanted);
  return (has_a || has_b) && is_in_mask(a, mask) && is_in_mask(b, mask) &&
         is_near(a, b, options->margin);
}

static unsigned char seen[IDS][IDS];

static hs_visit see_pairs(void* context, const hs_id_pair* pairs,
                          size_t count) {
  size_t i;
  CHECK(count > 0);
  for (i = 0; i < count; ++i) {
    CHECK(pairs[i].a < IDS / 3 && pairs[i].b < IDS);
    CHECK(!seen[pairs[i].a][pairs[i].b] && !seen[pairs[i].b][pairs[i].a]);
    seen[pairs[i].a][pairs[i].b] = 1;
  }
  *(size_t*)context += count;
  return HS_CONTINUE;
}
static hs_visit stop_at_pairs(void* context, const hs_id_pair* pairs,
                              size_t count) {
  CHECK(pairs != NULL && count > 0);
  ++*(size_t*)context;
  return HS_STOP;
}

static hs_visit see_pairs_of_bvh(void* context, const hs_id_pair* pairs,
                                 size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    const uint32_t a = bvh_ids[pairs[i].a];
    const uint32_t b = bvh_ids[pairs[i].b];
    CHECK(seen[a][b] || (b < IDS / 3 && seen[b][a]));
  }
  *(size_t*)context += count;
  return HS_CONTINUE;
}

static void check_pairs_of(const hs_pair_options* options) {
  static uint32_t set[IDS];
  static uint32_t set_of_bvh[IDS];
  static hs_id_pair pairs[IDS * IDS];
  hs_pair_options rest = *options;
  size_t size = 0;
  size_t total = 0;
  size_t calls = 0;
  size_t of_bvh = 0;
  size_t count = 0;
  size_t i;
  size_t a;
  size_t b;
  for (a = 0; a < IDS / 3; ++a) {
    if (its.has[a]) set[count++] = (uint32_t)a;
  }
  CHECK_OK(hs_bvh_size(bvh, &size));
  for (i = 0, b = 0; i < size && b < count; ++i) {
    if (bvh_ids[i] == set[b]) set_of_bvh[b++] = (uint32_t)i;
  }
  memset(seen, 0, sizeof(seen));
  CHECK_OK(hs_broad_phase_pairs_of_each(bodies, set, count, options, see_pairs,
                                        &calls));
  for (a = 0; a < IDS; ++a) {
    for (b = a + 1; b < IDS; ++b) {
      CHECK((seen[a][b] || seen[b][a]) == is_pair_of(a, b, options));
    }
  }
  CHECK(calls > 10);
  CHECK_OK(hs_bvh_pairs_of_each(bvh, set_of_bvh, count, options,
                                see_pairs_of_bvh, &of_bvh));
  CHECK(of_bvh == calls);
  CHECK_OK(
      hs_broad_phase_pairs_of(bodies, set, count, options, pairs, 5, &total));
  CHECK(total == calls);
  rest.skip = 5;
  CHECK_OK(hs_broad_phase_pairs_of(bodies, set, count, &rest, pairs + 5,
                                   IDS * IDS - 5, &total));
  for (i = 0; i < total; ++i) {
    CHECK(seen[pairs[i].a][pairs[i].b] == 1);
    seen[pairs[i].a][pairs[i].b] = 2;
  }
  CHECK(total == calls);
  CHECK_OK(hs_bvh_pairs_of(bvh, set_of_bvh, count, options, pairs, 0, &total));
  CHECK(total == calls);
  calls = 0;
  CHECK_OK(hs_broad_phase_pairs_of_each(bodies, set, count, options,
                                        stop_at_pairs, &calls));
  CHECK(calls == 1);
}

static void run_parts(void* context, size_t count, hs_part_function part,
                      void* work) {
  size_t i;
  ++*(size_t*)context;
  for (i = 0; i < count; ++i) part(work, i);
}

// Applies events to the pairs of the model.
static void take_events(int is_begin, const hs_id_pair* pairs, size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    const uint32_t a = pairs[i].a;
    const uint32_t b = pairs[i].b;
    CHECK(a < b && b < IDS && its.pairs[a][b] == !is_begin);
    CHECK(is_pair(a, b) == is_begin);
    CHECK(i == 0 || a > pairs[i - 1].a ||
          (a == pairs[i - 1].a && b > pairs[i - 1].b));
    its.pairs[a][b] = (unsigned char)is_begin;
  }
}

static void check_pairs(void) {
  static uint32_t wanted[IDS];
  hs_pair_options of_set;
  hs_update_options options;
  hs_body_statistics statistics;
  const hs_id_pair* pairs = NULL;
  size_t runs = 0;
  size_t listed = 0;
  size_t count = 0;
  size_t a;
  size_t b;
  CHECK_OK(hs_pair_options_default(&of_set, sizeof(of_set)));
  CHECK(of_set.wanted == NULL);
  check_pairs_of(&of_set);
  of_set.margin = 0.01f;
  check_pairs_of(&of_set);
  of_set.mask = 0xE;
  check_pairs_of(&of_set);
  of_set.mask = ALL;
  for (a = 0; a < IDS; ++a) wanted[a] = 2;
  of_set.wanted = wanted;
  check_pairs_of(&of_set);

  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  options.run = run_parts;
  options.run_context = &runs;
  CHECK_OK(hs_broad_phase_update_pairs(bodies, &options));
  CHECK_OK(hs_broad_phase_ended(bodies, &pairs, &listed));
  take_events(0, pairs, listed);
  CHECK_OK(hs_broad_phase_began(bodies, &pairs, &listed));
  take_events(1, pairs, listed);
  CHECK_OK(hs_broad_phase_pairs(bodies, &pairs, &listed));
  for (a = 0; a < IDS; ++a) {
    for (b = a + 1; b < IDS; ++b) {
      CHECK(its.pairs[a][b] == is_pair(a, b));
      count += its.pairs[a][b];
    }
  }
  CHECK(listed == count && count > 10);
  memset(seen, 0, sizeof(seen));
  for (a = 0; a < listed; ++a) {
    CHECK(its.pairs[pairs[a].a][pairs[a].b]);
    CHECK(!seen[pairs[a].a][pairs[a].b]);
    seen[pairs[a].a][pairs[a].b] = 1;
  }
  CHECK_OK(hs_broad_phase_statistics(bodies, &statistics, sizeof(statistics)));
  CHECK(statistics.pairs == count);
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
  float least[VALUES];
  size_t size = 0;
  size_t limit = 0;
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
  make_bvh();
  check_shapes(queries);
  check_nearest(queries);
  check_casts();
  check_pairs();
  hs_bvh_destroy(bvh);

  CHECK_OK(hs_broad_phase_size(bodies, &size));
  CHECK_OK(hs_broad_phase_id_limit(bodies, &limit));
  CHECK_OK(hs_broad_phase_bounds(bodies, around));
  for (v = 0; v < its.values; ++v) {
    least[v] = v < its.values / 2 ? INFINITY : -INFINITY;
  }
  for (i = 0; i < IDS; ++i) {
    int has = 2;
    CHECK_OK(hs_broad_phase_has(bodies, (uint32_t)i, &has));
    CHECK(has == its.has[i]);
    if (!has) continue;
    CHECK(i < limit);
    ids[count++] = (uint32_t)i;
    for (v = 0; v < its.values; ++v) {
      const float value = bound_of(i)[v];
      if (v < its.values / 2 ? value < least[v] : value > least[v]) {
        least[v] = value;
      }
    }
  }
  CHECK(memcmp(around, least, its.values * sizeof(float)) == 0);
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
  CHECK(statistics.bodies == size);
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
      its.masks[i].category = (uint32_t)1 << (i % 5);
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

// What a broad phase says after some changes, in its order.
typedef struct outcome {
  uint32_t ids[QUERIES * IDS];
  hs_id_pair pairs[3][IDS * 20];
  size_t sizes[4];
} outcome;

static void record_pairs(outcome* to, size_t list, hs_status status,
                         const hs_id_pair* pairs) {
  CHECK_OK(status);
  CHECK(to->sizes[list] <= IDS * 20);
  memcpy(to->pairs[list], pairs, to->sizes[list] * sizeof(*pairs));
}

static void change_and_record(outcome* to) {
  static float queries[QUERIES * VALUES];
  const hs_columns columns = hs_float_rows(queries, QUERIES, its.values);
  const hs_id_pair* pairs = NULL;
  hs_status status = HS_OK;
  memset(to, 0, sizeof(*to));
  random_bounds(its.kind, QUERIES, 0.2f, 61, queries);
  change(0, 1, 62);
  CHECK_OK(hs_broad_phase_update(bodies, NULL));
  CHECK_OK(hs_broad_phase_query(bodies, &columns, NULL, to->ids, QUERIES * IDS,
                                NULL, &to->sizes[3]));
  CHECK_OK(hs_broad_phase_update_pairs(bodies, NULL));
  status = hs_broad_phase_pairs(bodies, &pairs, &to->sizes[0]);
  record_pairs(to, 0, status, pairs);
  status = hs_broad_phase_began(bodies, &pairs, &to->sizes[1]);
  record_pairs(to, 1, status, pairs);
  status = hs_broad_phase_ended(bodies, &pairs, &to->sizes[2]);
  record_pairs(to, 2, status, pairs);
}

// A copy, and what was saved and loaded, go on as the original.
static void check_copies(const hs_broad_phase_config* config) {
  static outcome first;
  static outcome others;
  hs_broad_phase* all[3] = {bodies, NULL, NULL};
  size_t size = 0;
  size_t again = 0;
  char* bytes = NULL;
  int i;
  CHECK_OK(hs_broad_phase_copy(bodies, &all[1]));
  CHECK_OK(hs_broad_phase_save(bodies, NULL, 0, &size));
  bytes = malloc(size + 8);
  memset(bytes, 7, size + 8);
  CHECK_OK(hs_broad_phase_save(bodies, bytes, size / 2, &again));
  CHECK(again == size && bytes[size / 2] == 7);
  CHECK_OK(hs_broad_phase_save(bodies, bytes, size, &again));
  CHECK(again == size && bytes[size] == 7);
  CHECK_OK(hs_broad_phase_create(config, &all[2]));
  CHECK_OK(hs_broad_phase_load(all[2], bytes, size));

  // Wrong bytes change nothing.
  CHECK_FAILS(hs_broad_phase_load(all[2], bytes, 20), HS_CORRUPT,
              "hs_broad_phase_load: data: expected all bytes of "
              "BroadPhase::Save(), got 20 bytes");
  CHECK(hs_broad_phase_load(all[2], bytes, size - 64) == HS_CORRUPT);
  CHECK_INVALID(hs_broad_phase_load(all[2], NULL, size),
                "hs_broad_phase_load: data: expected a pointer, got null");
  bytes[9] ^= 1;
  CHECK(hs_broad_phase_load(all[2], bytes, size) == HS_CORRUPT);
  free(bytes);

  change_and_record(&first);
  CHECK(first.sizes[0] > 10 && first.sizes[1] > 0 && first.sizes[2] > 0);
  for (i = 1; i < 3; ++i) {
    bodies = all[i];
    change_and_record(&others);
    CHECK(memcmp(&first, &others, sizeof(first)) == 0);
    hs_broad_phase_destroy(bodies);
  }
  bodies = all[0];
}

static void test_history(hs_kind kind, int caller_locks) {
  hs_broad_phase_config config = config_of(kind);
  hs_update_options options;
  size_t runs = 0;
  uint32_t id = 4;
  int has = 1;
  memset(&its, 0, sizeof(its));
  its.kind = kind;
  its.values = hs_bound_values(kind);
  config.caller_locks = caller_locks;
  config.keep = keep_no_sevens;
  config.keep_context = &its;
  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  CHECK(options.budget == SIZE_MAX);
  options.run = run_parts;
  options.run_context = &runs;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_has(bodies, ALL, &has));
  CHECK(has == 0);
  change(1, 0, 41);
  change(1, 1, 42);
  check_all(43);
  change(0, 1, 44);
  erase(3, 9);
  check_all(45);
  check_copies(&config);
  // Its pairs are those of the last update_pairs().
  for (id = 0; id < IDS; ++id) {
    size_t b;
    for (b = id + 1; b < IDS; ++b) {
      its.pairs[id][b] = (unsigned char)is_pair(id, b);
    }
  }
  CHECK_OK(hs_broad_phase_update(bodies, NULL));
  check_all(46);
  id = 4;
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

static const float kFar[] = {9, 9, 9, 9};

// A callback moves the bodies, and its query goes on. Calls that wait for
// queries fail.
static hs_visit move_away(void* context, size_t query, const uint32_t* ids,
                          size_t count) {
#define INSIDE                                                            \
  "call: expected no query of the broad phase that still runs on this "   \
  "thread: this call waits for queries, got a call by the function of a " \
  "query"
  hs_columns columns = hs_float_rows(kFar, count, 4);
  const hs_body_masks masks = {1, 1};
  hs_body_statistics statistics;
  hs_broad_phase* copy = NULL;
  size_t n = 0;
  int is_valid = 0;
  char bytes[64] = {0};
  CHECK(query == 0);
  columns.stride = 0;
  *(size_t*)context += count;
  CHECK_OK(hs_broad_phase_move(bodies, ids, &columns));
  columns.count = 1;
  CHECK_OK(hs_broad_phase_count(bodies, &columns, NULL, &n));
  CHECK(n == count);
  CHECK_INVALID(hs_broad_phase_update(bodies, NULL),
                "hs_broad_phase_update: " INSIDE);
  CHECK_INVALID(hs_broad_phase_rebuild(bodies, NULL),
                "hs_broad_phase_rebuild: " INSIDE);
  CHECK_INVALID(hs_broad_phase_update_pairs(bodies, NULL),
                "hs_broad_phase_update_pairs: " INSIDE);
  CHECK_INVALID(hs_broad_phase_erase(bodies, ids, 1),
                "hs_broad_phase_erase: " INSIDE);
  CHECK_INVALID(hs_broad_phase_set_masks(bodies, ids, &masks, 1),
                "hs_broad_phase_set_masks: " INSIDE);
  CHECK_INVALID(hs_broad_phase_load(bodies, bytes, sizeof(bytes)),
                "hs_broad_phase_load: " INSIDE);
  CHECK_INVALID(hs_broad_phase_save(bodies, bytes, sizeof(bytes), &n),
                "hs_broad_phase_save: " INSIDE);
  CHECK_INVALID(hs_broad_phase_copy(bodies, &copy),
                "hs_broad_phase_copy: " INSIDE);
  CHECK_INVALID(hs_broad_phase_validate(bodies, &is_valid),
                "hs_broad_phase_validate: " INSIDE);
  CHECK_INVALID(
      hs_broad_phase_statistics(bodies, &statistics, sizeof(statistics)),
      "hs_broad_phase_statistics: " INSIDE);
  columns.count = 1;
  n = 7;
  CHECK_INVALID(
      hs_broad_phase_insert(bodies, (const uint32_t[]){7}, &columns, NULL),
      "hs_broad_phase_insert: " INSIDE);
  CHECK(copy == NULL);
  return HS_CONTINUE;
}

static void test_callbacks(void) {
  const float boxes[] = {0, 0, 1, 1};
  const uint32_t ids[] = {0, 1, 2};
  const hs_broad_phase_config config = config_of(HS_BOX2);
  hs_columns columns = hs_float_rows(boxes, 3, 4);
  const hs_columns far = hs_float_rows(kFar, 1, 4);
  hs_body_masks masks[3];
  size_t calls = 0;
  size_t size = 0;
  columns.stride = 0;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &columns, NULL));
  CHECK_OK(hs_broad_phase_get(bodies, ids, 3, NULL, masks));
  CHECK(masks[2].category == ALL && masks[2].collides_with == ALL);
  columns.count = 1;
  CHECK_OK(hs_broad_phase_probe(bodies, &columns, NULL, move_away, &calls));
  CHECK(calls == 3);
  CHECK_OK(hs_broad_phase_count(bodies, &columns, NULL, &size));
  CHECK(size == 0);
  CHECK_OK(hs_broad_phase_count(bodies, &far, NULL, &size));
  CHECK(size == 3);
  CHECK_OK(hs_broad_phase_update(bodies, NULL));
  hs_broad_phase_destroy(bodies);
  hs_broad_phase_destroy(NULL);
}

static void test_moves_that_wait(void) {
  const float box[] = {0, 0, 1, 1};
  const uint32_t id = 1000000;  // ids may have gaps
  const hs_columns columns = hs_float_rows(box, 1, 4);
  const hs_columns far = hs_float_rows(kFar, 1, 4);
  hs_broad_phase_config config = config_of(HS_BOX2);
  float record[4];
  size_t count = 0;
  config.moves_wait_for_update = 1;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, &id, &columns, NULL));
  CHECK_OK(hs_broad_phase_move(bodies, &id, &far));
  CHECK_OK(hs_broad_phase_count(bodies, &far, NULL, &count));
  CHECK(count == 0);
  CHECK_OK(hs_broad_phase_get(bodies, &id, 1, record, NULL));
  CHECK(memcmp(record, kFar, sizeof(record)) == 0);
  CHECK_OK(hs_broad_phase_update(bodies, NULL));
  CHECK_OK(hs_broad_phase_count(bodies, &far, NULL, &count));
  CHECK(count == 1);
  hs_broad_phase_destroy(bodies);
}

static float take_t(void* context, size_t cast, uint32_t id, float t) {
  CHECK(cast == 0 && id == 0);
  *(float*)context = t;
  return INFINITY;
}

// Of a body and of an object.
static void test_sphere_cast(void) {
  const float box[] = {4, 0, 5, 1};
  const float sphere[] = {0, 0.5f, 1};
  const float motion[] = {2, 0, 10};
  const uint32_t id = 0;
  const hs_broad_phase_config config = config_of(HS_BOX2);
  const hs_bvh_config bvh_config = bvh_config_of(HS_BOX2);
  const hs_columns columns = hs_float_rows(box, 1, 4);
  const hs_columns starts = hs_float_rows(sphere, 1, 3);
  const hs_columns motions = hs_float_rows(motion, 1, 3);
  uint32_t first = 7;
  float t = 0;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, &id, &columns, NULL));
  CHECK_OK(hs_broad_phase_spherecast_each(bodies, &starts, &motions, NULL,
                                          take_t, &t));
  CHECK(t <= 1.5f && t > 1.4999f);
  hs_broad_phase_destroy(bodies);
  CHECK_OK(hs_bvh_create(&bvh_config, &columns, &bvh));
  CHECK_OK(hs_bvh_spherecast(bvh, &starts, &motions, NULL, &first, &t));
  CHECK(first == 0 && t <= 1.5f && t > 1.4999f);
  CHECK_OK(hs_bvh_boxcast(bvh, &columns, &motions, NULL, &first, &t));
  CHECK(first == 0 && t == 0);
  hs_bvh_destroy(bvh);
}

static void test_errors_of_bodies(void) {
  const float boxes[] = {0, 0, 1, 1, 2, 2, 3, 3};
  const double doubles[] = {0, 0, 1, 2};
  const float motion[] = {1, 0, -1};
  const uint32_t ids[] = {5, IDS};
  const uint32_t large[] = {5, (uint32_t)1 << 31};
  const uint32_t twice[] = {5, 5};
  const hs_body_masks masks[] = {{1, 1}, {1, 1}};
  hs_columns columns = hs_float_rows(boxes, 2, 4);
  hs_columns one = hs_float_rows(boxes, 1, 4);
  hs_columns motions = hs_float_rows(motion, 1, 3);
  hs_broad_phase_config config = config_of(HS_SIMPLEX2);
  hs_query_options query = options_of(HS_SHAPE_SPHERE, ALL);
  hs_update_options options;
  hs_pair_options pair_options;
  hs_body_statistics statistics;
  hs_id_pair pair;
  float record[4];
  uint32_t id = 0;
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
  CHECK_INVALID(hs_broad_phase_create(NULL, &bodies),
                "hs_broad_phase_create: config: expected a pointer, got null");
  CHECK(bodies == NULL);
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_INVALID(hs_broad_phase_insert(bodies, large, &columns, NULL),
                "hs_broad_phase_insert: ids[1]: expected an id below 2^31, got "
                "2147483648");
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
  CHECK_INVALID(hs_broad_phase_probe(bodies, &one, NULL, NULL, NULL),
                "hs_broad_phase_probe: function: expected a pointer, got null");
  one = hs_double_rows(doubles, 1, 3);
  CHECK_INVALID(hs_broad_phase_probe(bodies, &one, &query, take_ids, &got),
                "hs_broad_phase_probe: queries->type: expected HS_FLOAT32, as "
                "these cannot be rounded outward, got HS_FLOAT64");
  CHECK_INVALID(hs_broad_phase_count(bodies, &motions, &query, &size),
                "hs_broad_phase_count: radius: expected a number that is not "
                "negative, got -1");
  query.shape = (hs_shape)3;
  CHECK_INVALID(hs_broad_phase_any(bodies, &motions, &query, &id),
                "hs_broad_phase_any: options->shape: expected an enumerator of "
                "hs_shape, got 3");
  query = options_of(HS_SHAPE_BOUND, ALL);
  query.exclusive = 1;
  one = hs_float_rows(boxes, 1, 4);
  CHECK_INVALID(
      hs_broad_phase_nearest_to_points(bodies, &one, 1, 1, &query, &id, NULL),
      "hs_broad_phase_nearest_to_points: options->exclusive: expected 0, as "
      "this is an option of BVHs alone, got 1");
  CHECK_INVALID(
      hs_broad_phase_nearest_to_boxes(bodies, &one, 1, -1, NULL, &id, NULL),
      "hs_broad_phase_nearest_to_boxes: max_distance: expected a number that "
      "is not negative, got -1");
  CHECK_INVALID(
      hs_broad_phase_spherecast(bodies, &motions, &one, NULL, &id, NULL),
      "hs_broad_phase_spherecast: spheres->column[2]: expected radii that are "
      "not negative, got -1 of sphere 0");
  CHECK_INVALID(
      hs_broad_phase_boxcast(bodies, &one, &motions, NULL, &id, NULL),
      "hs_broad_phase_boxcast: motions->column[2]: expected limits of t that "
      "are not negative, got -1 of motion 0");
  CHECK_INVALID(
      hs_broad_phase_boxcast_each(bodies, &columns, &motions, NULL, take_hit,
                                  &got),
      "hs_broad_phase_boxcast_each: motions->count: expected one for each of 2 "
      "boxes, got 1");
  CHECK_INVALID(
      hs_broad_phase_boxcast(bodies, &one, &motions, NULL, NULL, NULL),
      "hs_broad_phase_boxcast: ids: expected a pointer, got null");
  CHECK_INVALID(
      hs_broad_phase_raycast_each(bodies, &one, 0, NULL, NULL, NULL),
      "hs_broad_phase_raycast_each: function: expected a pointer, got null");
  motions = hs_double_rows(doubles, 1, 3);
  CHECK_INVALID(
      hs_broad_phase_boxcast_each(bodies, &one, &motions, NULL, take_hit, &got),
      "hs_broad_phase_boxcast_each: motions->type: expected HS_FLOAT32, as "
      "these cannot be rounded outward, got HS_FLOAT64");
  CHECK_INVALID(
      hs_broad_phase_pairs_of(bodies, ids, 2, NULL, &pair, 1, &size),
      "hs_broad_phase_pairs_of: ids[1]: expected the id of a body, got "
      "900");
  CHECK_OK(hs_pair_options_default(&pair_options, sizeof(pair_options)));
  pair_options.margin = -1;
  CHECK_INVALID(
      hs_broad_phase_pairs_of(bodies, ids, 1, &pair_options, &pair, 1, &size),
      "hs_broad_phase_pairs_of: options->margin: expected a finite number that "
      "is not negative, got -1");
  CHECK_INVALID(hs_broad_phase_began(bodies, NULL, &size),
                "hs_broad_phase_began: pairs: expected a pointer, got null");
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
    if (!is_simplex(kind_of(kind))) test_history(kind_of(kind), kind % 2);
  }
  test_callbacks();
  test_moves_that_wait();
  test_sphere_cast();
  test_errors_of_bodies();
}
