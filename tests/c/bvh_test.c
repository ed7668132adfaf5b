// Hierarchies: queries, nearest, rays and pairs, against every object.
#include <math.h>
#include <stdlib.h>

#include "check.h"

enum { OBJECTS = 5000, QUERIES = 300, VALUES = 8 };

static float objects[OBJECTS * VALUES];
static float queries[QUERIES * VALUES];

static hs_bvh* bvh_of(hs_kind kind, const float* records, size_t count) {
  const hs_bvh_config config = bvh_config_of(kind);
  const hs_columns columns =
      hs_float_rows(records, count, hs_bound_values(kind));
  hs_bvh* bvh = NULL;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  return bvh;
}

typedef struct probe {
  const hs_kind kind;
  size_t calls;
  size_t ids;
  size_t last_query;
  size_t stop_after;
} probe;

static hs_visit count_ids(void* context, size_t query, const uint32_t* ids,
                          size_t count) {
  probe* const its = context;
  const size_t values = hs_bound_values(its->kind);
  size_t i;
  CHECK(query >= its->last_query && count > 0);
  for (i = 0; i < count; ++i) {
    CHECK(survives(its->kind, objects + ids[i] * values,
                   queries + query * values));
  }
  its->last_query = query;
  its->ids += count;
  return ++its->calls == its->stop_after ? HS_STOP : HS_CONTINUE;
}

static void test_kind(hs_kind kind) {
  static uint32_t ids[QUERIES * 400];
  static size_t offsets[QUERIES + 1];
  static size_t counts[QUERIES];
  static uint32_t any[QUERIES];
  const size_t values = hs_bound_values(kind);
  hs_columns asked = hs_float_rows(queries, QUERIES, values);
  hs_query_options options;
  size_t total = 0;
  size_t again = 0;
  size_t q;
  size_t i;
  hs_bvh* bvh;
  random_bounds(kind, OBJECTS, dims_of(kind) == 2 ? 0.05f : 0.15f, 3, objects);
  random_bounds(kind, QUERIES, dims_of(kind) == 2 ? 0.05f : 0.15f, 4, queries);
  objects[7 * values] = NAN;
  for (i = 0; i < values; ++i) {
    objects[9 * values + i] = i < values / 2 ? INFINITY : -INFINITY;
  }
  // Inverted.
  objects[11 * values + values / 2] = objects[11 * values] - 0.01f;
  bvh = bvh_of(kind, objects, OBJECTS);
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  CHECK_OK(hs_bvh_query(bvh, &asked, NULL, ids, 0, NULL, &total));
  CHECK(total > QUERIES && total <= sizeof(ids) / sizeof(ids[0]));
  CHECK_OK(hs_bvh_query(bvh, &asked, &options, ids,
                        sizeof(ids) / sizeof(ids[0]), offsets, &again));
  CHECK(again == total && offsets[0] == 0 && offsets[QUERIES] == total);
  CHECK_OK(hs_bvh_count(bvh, &asked, NULL, counts));
  CHECK_OK(hs_bvh_any(bvh, &asked, NULL, any));
  for (q = 0; q < QUERIES; ++q) {
    unsigned char found[OBJECTS] = {0};
    size_t count = 0;
    for (i = offsets[q]; i < offsets[q + 1]; ++i) {
      CHECK(!found[ids[i]]);
      found[ids[i]] = 1;
    }
    for (i = 0; i < OBJECTS; ++i) {
      const int expected =
          survives(kind, objects + i * values, queries + q * values);
      CHECK(found[i] == expected);
      count += (size_t)expected;
    }
    CHECK(counts[q] == count);
    CHECK(count == 0 ? any[q] == HS_NO_ID : found[any[q]]);
  }

  // In pieces, of one id and of more, also of queries that are not rows.
  {
    const size_t pieces[] = {1, 100};
    size_t p;
    for (p = 0; p < 2; ++p) {
      uint32_t piece[100];
      options.skip = p == 0 ? total - 300 : 0;
      for (; options.skip < total; options.skip += pieces[p]) {
        CHECK_OK(hs_bvh_query(bvh, &asked, &options, piece, pieces[p], NULL,
                              &again));
        CHECK(again == total);
        for (i = 0; i < pieces[p] && options.skip + i < total; ++i) {
          CHECK(piece[i] == ids[options.skip + i]);
        }
      }
    }
    options.skip = 0;
  }
  {
    // 8 columns with a stride that is not theirs.
    static float wide[QUERIES * 9];
    hs_columns columns = hs_float_rows(wide, QUERIES, 9);
    for (q = 0; q < QUERIES; ++q) {
      memcpy(wide + 9 * q, queries + q * values, values * sizeof(float));
    }
    CHECK_OK(hs_bvh_query(bvh, &columns, NULL, ids, 0, offsets, &again));
    CHECK(again == total && offsets[QUERIES] == total);
    for (q = 0; q < QUERIES; ++q) {
      CHECK(offsets[q + 1] - offsets[q] == counts[q]);
    }
  }

  {
    probe all = {kind, 0, 0, 0, 0};
    probe first = {kind, 0, 0, 0, 1};
    CHECK_OK(hs_bvh_probe(bvh, &asked, NULL, count_ids, &all));
    CHECK(all.ids == total && all.last_query > QUERIES / 2);
    CHECK_OK(hs_bvh_probe(bvh, &asked, &options, count_ids, &first));
    CHECK(first.calls == 1);
    // More results than are kept at a time.
    all.ids = all.last_query = 0;
    random_bounds(kind, QUERIES, 2, 14, queries);
    CHECK_OK(hs_bvh_query(bvh, &asked, NULL, NULL, 0, NULL, &again));
    CHECK(again > QUERIES * 500);
    CHECK_OK(hs_bvh_probe(bvh, &asked, NULL, count_ids, &all));
    CHECK(all.ids == again);
    first.calls = first.last_query = 0;
    CHECK_OK(hs_bvh_probe(bvh, &asked, NULL, count_ids, &first));
    CHECK(first.calls == 1);
  }
  options.mask = 0;
  options.target = hs_target_name(hs_target_count() - 1);
  CHECK_OK(hs_bvh_query(bvh, &asked, &options, ids, 1, offsets, &again));
  CHECK(again == 0 && offsets[QUERIES] == 0);
  hs_bvh_destroy(bvh);
}

static void test_double_columns(void) {
  // As columns of a database: the object ends at 0.1, which is no float.
  const double min_x[] = {0, 0.5};
  const double min_y[] = {0, 0};
  const double max_x[] = {0.1, 0.6};
  const double max_y[] = {1, 1};
  const double query[] = {0.10000000149, 0, 0.15, 1};
  const float exact[] = {0.1f, 0, 0.15f, 1};
  const hs_bvh_config config = bvh_config_of(HS_BOX2);
  hs_columns columns = hs_double_rows(NULL, 2, 0);
  hs_columns asked = hs_double_rows(query, 1, 4);
  hs_bvh* bvh = NULL;
  float record[4];
  uint32_t id = 9;
  size_t total = 0;
  columns.stride = 1;
  columns.column[0] = min_x;
  columns.column[1] = min_y;
  columns.column[2] = max_x;
  columns.column[3] = max_y;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_query(bvh, &asked, NULL, &id, 1, NULL, &total));
  CHECK(total == 1 && id == 0);
  asked = hs_float_rows(exact, 1, 4);
  CHECK_OK(hs_bvh_query(bvh, &asked, NULL, &id, 1, NULL, &total));
  CHECK(total == 1 && id == 0);
  CHECK_OK(hs_bvh_bounds(bvh, record));
  CHECK(record[0] == 0 && (double)record[2] >= 0.6 && record[3] == 1);
  hs_bvh_destroy(bvh);
  hs_bvh_destroy(NULL);
}

// The query of simplices is its maxima: 0.7 becomes the float above it.
static void test_double_maxima(void) {
  const float object[] = {nextafterf(0.7f, 1), 0, -9, 0, 0, 0};
  const double query[] = {0, 0, 0, 0.7, 0, 0};
  const hs_columns asked = hs_double_rows(query, 1, 6);
  hs_bvh* const bvh = bvh_of(HS_SIMPLEX2, object, 1);
  size_t count = 0;
  CHECK(object[0] > 0.7f && query[3] < (double)object[0]);
  CHECK_OK(hs_bvh_count(bvh, &asked, NULL, &count));
  CHECK(count == 1);
  hs_bvh_destroy(bvh);
}

typedef struct answers {
  size_t counts[QUERIES];
  uint32_t any[QUERIES];
  uint32_t nearest_to_points[QUERIES];
  uint32_t nearest_to_boxes[QUERIES];
  uint32_t hits[QUERIES];
  size_t probed;
  size_t touched;
} answers;

static hs_visit add_ids(void* context, size_t query, const uint32_t* ids,
                        size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    CHECK(ids[i] < OBJECTS);
    if (ids[i] >= OBJECTS) return HS_STOP;
    ((answers*)context)->probed += (query + 1) * (ids[i] + 1);
  }
  return HS_CONTINUE;
}
static float add_hit(void* context, size_t ray, uint32_t id, float t) {
  (void)t;
  ((answers*)context)->touched += (ray + 1) * (id + 1);
  return INFINITY;
}

static void get_answers(const hs_bvh* bvh, const hs_query_options* options,
                        answers* to) {
  const hs_columns asked = hs_float_rows(queries, QUERIES, 4);
  const hs_columns points = hs_float_rows(queries, QUERIES, 2);
  static float rays[QUERIES * 5];
  const hs_columns columns = hs_float_rows(rays, QUERIES, 5);
  size_t q;
  for (q = 0; q < QUERIES; ++q) {
    memcpy(rays + 5 * q, queries + 4 * q, 2 * sizeof(float));
    rays[5 * q + 2] = rays[5 * q + 3] = rays[5 * q + 4] = 1;
  }
  memset(to, 0, sizeof(*to));
  CHECK_OK(hs_bvh_count(bvh, &asked, options, to->counts));
  CHECK_OK(hs_bvh_any(bvh, &asked, options, to->any));
  CHECK_OK(hs_bvh_probe(bvh, &asked, options, add_ids, to));
  CHECK_OK(hs_bvh_nearest_to_points(bvh, &points, 1, 1, options,
                                    to->nearest_to_points, NULL));
  CHECK_OK(hs_bvh_nearest_to_boxes(bvh, &asked, 1, 1, options,
                                   to->nearest_to_boxes, NULL));
  CHECK_OK(hs_bvh_raycast(bvh, &columns, 0, options, to->hits, NULL));
  CHECK_OK(hs_bvh_raycast_each(bvh, &columns, 0, options, add_hit, to));
}

// hs_bvh_query() alone skips results.
static void test_skip_elsewhere(void) {
  static answers all;
  static answers skipped;
  const size_t skips[] = {1, 100, SIZE_MAX};
  hs_query_options options;
  hs_bvh* bvh;
  size_t i;
  random_bounds(HS_BOX2, OBJECTS, 0.05f, 15, objects);
  random_bounds(HS_BOX2, QUERIES, 0.05f, 16, queries);
  bvh = bvh_of(HS_BOX2, objects, OBJECTS);
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  get_answers(bvh, &options, &all);
  CHECK(all.probed > 0 && all.touched > 0);
  for (i = 0; i < sizeof(skips) / sizeof(skips[0]); ++i) {
    options.skip = skips[i];
    get_answers(bvh, &options, &skipped);
    CHECK(memcmp(&all, &skipped, sizeof(all)) == 0);
  }
  hs_bvh_destroy(bvh);
}

void test_queries(void) {
  int kind;
  test_double_maxima();
  test_skip_elsewhere();
  for (kind = 0; kind < KINDS; ++kind) test_kind(kind_of(kind));
  test_double_columns();
}

// The distance of a point or a box to a box; 0 if they touch.
static double distance(const float* from, const float* box, size_t dims) {
  double sum = 0;
  size_t k;
  for (k = 0; k < dims; ++k) {
    double gap = 0;
    if (box[k] > from[dims + k]) gap = (double)box[k] - from[dims + k];
    if (from[k] > box[dims + k]) gap = (double)from[k] - box[dims + k];
    sum += gap * gap;
  }
  return sqrt(sum);
}

static int by_value(const void* a, const void* b) {
  const double left = *(const double*)a;
  const double right = *(const double*)b;
  return (left > right) - (left < right);
}

static void check_nearest(const hs_bvh* bvh, size_t dims, const float* box,
                          const uint32_t* ids, const float* found, size_t k,
                          double limit) {
  static double all[OBJECTS];
  size_t i;
  (void)bvh;
  for (i = 0; i < OBJECTS; ++i) {
    all[i] = distance(box, objects + i * 2 * dims, dims);
  }
  for (i = 0; i < k; ++i) {
    if (ids[i] == HS_NO_ID) continue;
    CHECK(fabs(all[ids[i]] - found[i]) <= 2e-6 * found[i] + 1e-20);
  }
  qsort(all, OBJECTS, sizeof(all[0]), by_value);
  for (i = 0; i < k; ++i) {
    if (i >= OBJECTS || all[i] > limit) {
      CHECK(ids[i] == HS_NO_ID && found[i] == INFINITY);
    } else {
      CHECK(fabs(all[i] - found[i]) <= 2e-6 * found[i] + 1e-20);
    }
  }
}

static void test_nearest(hs_kind kind) {
  enum { K = 5 };
  const size_t dims = dims_of(kind);
  static uint32_t ids[QUERIES * K];
  static float distances[QUERIES * K];
  static double doubles[QUERIES * 3];
  hs_columns boxes = hs_float_rows(queries, QUERIES, 2 * dims);
  hs_columns points = hs_float_rows(queries, QUERIES, dims);
  hs_query_options options;
  hs_bvh* bvh;
  size_t q;
  size_t k;
  random_bounds(kind, OBJECTS, 0.01f, 5, objects);
  random_bounds(kind, QUERIES, 0.01f, 6, queries);
  bvh = bvh_of(kind, objects, OBJECTS);
  CHECK_OK(
      hs_bvh_nearest_to_boxes(bvh, &boxes, K, 0.02f, NULL, ids, distances));
  for (q = 0; q < QUERIES; ++q) {
    check_nearest(bvh, dims, queries + q * 2 * dims, ids + q * K,
                  distances + q * K, K, (double)0.02f);
  }
  CHECK_OK(hs_bvh_nearest_to_points(bvh, &points, K, INFINITY, NULL, ids,
                                    distances));
  for (q = 0; q < QUERIES; ++q) {
    float box[6];
    for (k = 0; k < dims; ++k) {
      box[k] = box[dims + k] = queries[q * dims + k];
      doubles[q * dims + k] = (double)box[k];
    }
    check_nearest(bvh, dims, box, ids + q * K, distances + q * K, K, INFINITY);
  }
  {
    // Points of doubles that are floats, and ids alone.
    static uint32_t others[QUERIES * K];
    points = hs_double_rows(doubles, QUERIES, dims);
    CHECK_OK(hs_query_options_default(&options, sizeof(options)));
    CHECK_OK(hs_bvh_nearest_to_points(bvh, &points, K, INFINITY, &options,
                                      others, NULL));
    CHECK(memcmp(others, ids, sizeof(ids)) == 0);
    // Nothing to write.
    CHECK_OK(
        hs_bvh_nearest_to_points(bvh, &points, 0, INFINITY, NULL, NULL, NULL));
  }
  hs_bvh_destroy(bvh);
}

// The objects as queries, each of which is there twice.
static void test_nearest_others(hs_kind kind) {
  enum { K = 5, SOME = OBJECTS / 2 };
  const size_t values = hs_bound_values(kind);
  const hs_columns asked = hs_float_rows(objects, QUERIES, values);
  static uint32_t ids[QUERIES * K];
  static uint32_t others[QUERIES * K];
  static float distances[QUERIES * K];
  static float all[QUERIES * (K + 2)];
  static uint32_t ids_of_all[QUERIES * (K + 2)];
  hs_query_options options;
  hs_bvh* bvh;
  size_t q;
  size_t k;
  random_bounds(kind, SOME, 0.01f, 7, objects);
  memcpy(objects + SOME * values, objects, SOME * values * sizeof(float));
  bvh = bvh_of(kind, objects, OBJECTS);
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  CHECK_OK(hs_bvh_nearest_to_boxes(bvh, &asked, K + 2, INFINITY, &options,
                                   ids_of_all, all));
  options.exclusive = 1;
  CHECK_OK(hs_bvh_nearest_to_boxes(bvh, &asked, K, INFINITY, &options, ids,
                                   distances));
  CHECK_OK(hs_bvh_nearest_to_boxes(bvh, &asked, K, INFINITY, &options, others,
                                   NULL));
  CHECK(memcmp(ids, others, sizeof(ids)) == 0);
  for (q = 0; q < QUERIES; ++q) {
    for (k = 0; k < K; ++k) {
      CHECK(ids[q * K + k] % SOME != q);
      CHECK(distances[q * K + k] == all[q * (K + 2) + k + 2]);
    }
  }
  CHECK_OK(
      hs_bvh_nearest_to_boxes(bvh, &asked, 1, 0, &options, ids, distances));
  for (q = 0; q < QUERIES; ++q) {
    CHECK(distances[q] == 0 || (ids[q] == HS_NO_ID && isinf(distances[q])));
  }
  hs_bvh_destroy(bvh);
}

typedef struct hits {
  size_t of_ray[QUERIES];
  float closest;
  size_t ray;
} hits;

static float count_hits(void* context, size_t ray, uint32_t id, float t) {
  hits* const its = context;
  CHECK(id < OBJECTS && t >= 0 && ray >= its->ray);
  its->ray = ray;
  ++its->of_ray[ray];
  return INFINITY;
}
static float end_rays(void* context, size_t ray, uint32_t id, float t) {
  hits* const its = context;
  (void)id;
  (void)t;
  ++its->of_ray[ray];
  return -1;
}

static void test_rays(hs_kind kind) {
  const size_t dims = dims_of(kind);
  const size_t row = 2 * dims + 1;
  static float rays[QUERIES * 7];
  static uint32_t ids[QUERIES];
  static float ts[QUERIES];
  hits all = {{0}, 0, 0};
  hits ended = {{0}, 0, 0};
  hs_columns columns = hs_float_rows(rays, QUERIES, row);
  uint32_t seed = 8;
  size_t hit = 0;
  size_t q;
  size_t i;
  size_t k;
  hs_bvh* bvh;
  random_bounds(kind, OBJECTS, dims_of(kind) == 2 ? 0.05f : 0.15f, 7, objects);
  bvh = bvh_of(kind, objects, OBJECTS);
  for (q = 0; q < QUERIES; ++q) {
    for (k = 0; k < dims; ++k) {
      rays[q * row + k] = 2 * random_float(&seed) - 0.5f;
      rays[q * row + dims + k] = random_float(&seed) - 0.5f;
    }
    rays[q * row + 2 * dims] = q % 2 == 0 ? 1.0f : INFINITY;
  }
  CHECK_OK(hs_bvh_raycast(bvh, &columns, 0, NULL, ids, ts));
  CHECK_OK(hs_bvh_raycast_each(bvh, &columns, 0, NULL, count_hits, &all));
  CHECK_OK(hs_bvh_raycast_each(bvh, &columns, 0, NULL, end_rays, &ended));
  for (q = 0; q < QUERIES; ++q) {
    const float* const ray = rays + q * row;
    double closest = INFINITY;
    size_t count = 0;
    for (i = 0; i < OBJECTS; ++i) {
      const float* const box = objects + i * 2 * dims;
      double enter = 0;
      double leave = (double)ray[2 * dims];
      for (k = 0; k < dims; ++k) {
        const double low = ((double)box[k] - ray[k]) / ray[dims + k];
        const double high = ((double)box[dims + k] - ray[k]) / ray[dims + k];
        enter = fmax(enter, fmin(low, high));
        leave = fmin(leave, fmax(low, high));
      }
      if (enter > leave) continue;
      ++count;
      closest = fmin(closest, enter);
    }
    // Rays that graze a corner are found by one of the two computations.
    CHECK(all.of_ray[q] >= count && all.of_ray[q] <= count + 1);
    CHECK(ended.of_ray[q] == (all.of_ray[q] != 0));
    CHECK(ids[q] == HS_NO_ID ? ts[q] == INFINITY && count == 0
                             : (double)ts[q] <= closest &&
                                   (double)ts[q] >= closest * 0.9999 - 1e-6);
    hit += ids[q] != HS_NO_ID;
  }
  CHECK(hit > QUERIES / 4 && hit < QUERIES);
  CHECK_OK(hs_bvh_raycast(bvh, &columns, 10, NULL, ids, NULL));
  for (q = 0; q < QUERIES; ++q) CHECK(ids[q] != HS_NO_ID);
  hs_bvh_destroy(bvh);
}

static void test_double_points(void) {
  // 0.7 is between this float and the one below it: both are in the box of the
  // point, although the other is nearer.
  const float above = nextafterf(0.7f, 1);
  const float box[] = {above, 0, 1, 0};
  const double point[] = {0.7, 0};
  const hs_columns points = hs_double_rows(point, 1, 2);
  hs_bvh* const bvh = bvh_of(HS_BOX2, box, 1);
  uint32_t id = 9;
  float found = 9;
  CHECK((double)above > 0.7 && above > 0.7f);
  CHECK_OK(
      hs_bvh_nearest_to_points(bvh, &points, 1, INFINITY, NULL, &id, &found));
  CHECK(id == 0 && found == 0);
  hs_bvh_destroy(bvh);
}

// Of objects that a ray enters at the same time, the first.
static void test_equal_hits(void) {
  const float box[] = {1, -1, 2, 1};
  const float ray[] = {0, 0, 1, 0, INFINITY};
  const hs_bvh_config config = bvh_config_of(HS_BOX2);
  const hs_columns rays = hs_float_rows(ray, 1, 5);
  hs_columns columns = hs_float_rows(box, 1000, 4);
  hs_bvh* bvh = NULL;
  uint32_t id = 9;
  float t = 0;
  columns.stride = 0;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_raycast(bvh, &rays, 0, NULL, &id, &t));
  CHECK(id == 0 && t > 0.9999f && t <= 1);
  hs_bvh_destroy(bvh);
}

void test_nearest_and_rays(void) {
  test_double_points();
  test_equal_hits();
  test_nearest(HS_BOX2);
  test_nearest(HS_BOX3);
  test_nearest_others(HS_BOX2);
  test_nearest_others(HS_BOX3);
  test_rays(HS_BOX2);
  test_rays(HS_BOX3);
}

typedef struct pair_list {
  hs_id_pair pairs[100000];
  size_t count;
  int stop;
} pair_list;

static hs_visit add_pairs(void* context, const hs_id_pair* pairs,
                          size_t count) {
  pair_list* const list = context;
  CHECK(list->count + count <= sizeof(list->pairs) / sizeof(list->pairs[0]));
  memcpy(list->pairs + list->count, pairs, count * sizeof(*pairs));
  list->count += count;
  return list->stop ? HS_STOP : HS_CONTINUE;
}

static void test_pairs_of(hs_kind kind) {
  enum { LEFT = 900, RIGHT = 1100 };
  static pair_list list;
  static hs_id_pair pairs[100000];
  const size_t values = hs_bound_values(kind);
  float* const others = objects + LEFT * values;
  hs_bvh* a;
  hs_bvh* b;
  hs_pair_options options;
  size_t total = 0;
  size_t again = 0;
  size_t parts = 0;
  size_t of_parts = 0;
  size_t count = 0;
  size_t i;
  size_t j;
  random_bounds(kind, LEFT + RIGHT, dims_of(kind) == 2 ? 0.1f : 0.2f, 9,
                objects);
  a = bvh_of(kind, objects, LEFT);
  b = bvh_of(kind, others, RIGHT);
  CHECK_OK(hs_pair_options_default(&options, sizeof(options)));

  for (i = 0; i < LEFT; ++i) {
    for (j = 0; j < i; ++j) {
      count +=
          (size_t)survives(kind, objects + i * values, objects + j * values);
    }
  }
  CHECK_OK(hs_bvh_pairs(a, NULL, pairs, 100000, &total));
  CHECK(total == count && count > 1000);
  list.count = 0;
  list.stop = 0;
  CHECK_OK(hs_bvh_pairs_each(a, &options, add_pairs, &list));
  CHECK(list.count == total);
  CHECK(memcmp(list.pairs, pairs, total * sizeof(pairs[0])) == 0);
  for (options.skip = 0; options.skip < total; options.skip += 97) {
    hs_id_pair one;
    CHECK_OK(hs_bvh_pairs(a, &options, &one, 1, &again));
    CHECK(again == total && one.a == pairs[options.skip].a &&
          one.b == pairs[options.skip].b);
  }
  options.skip = 0;
  CHECK_OK(hs_bvh_pair_parts(a, &parts));
  CHECK(parts == (LEFT + 63) / 64);
  for (i = 0; i < parts; ++i) {
    options.begin = i;
    options.end = i + 1;
    CHECK_OK(hs_bvh_pairs(a, &options, NULL, 0, &again));
    of_parts += again;
  }
  CHECK(of_parts == total);

  CHECK_OK(hs_pair_options_default(&options, sizeof(options)));
  for (i = 0, count = 0; i < LEFT; ++i) {
    for (j = 0; j < RIGHT; ++j) {
      count +=
          (size_t)survives(kind, objects + i * values, others + j * values);
    }
  }
  CHECK_OK(hs_bvh_join(a, b, NULL, pairs, 100000, &total));
  CHECK(total == count && count > 1000);
  for (i = 0; i < total; ++i) {
    CHECK(survives(kind, objects + pairs[i].a * values,
                   others + pairs[i].b * values));
  }
  list.count = 0;
  CHECK_OK(hs_bvh_join_each(a, b, NULL, add_pairs, &list));
  CHECK(list.count == total);
  list.count = 0;
  list.stop = 1;
  CHECK_OK(hs_bvh_join_each(a, b, NULL, add_pairs, &list));
  CHECK(list.count > 0 && list.count <= 256);
  options.margin = 0.1f;
  options.target = hs_target_name(0);
  CHECK_OK(hs_bvh_join(a, b, &options, NULL, 0, &again));
  CHECK(again > total);
  options.mask = 0;
  CHECK_OK(hs_bvh_join(a, b, &options, NULL, 0, &again));
  CHECK(again == 0);
  hs_bvh_destroy(a);
  hs_bvh_destroy(b);
}

void test_pairs(void) {
  test_pairs_of(HS_BOX2);
  test_pairs_of(HS_BOX3);
  test_pairs_of(HS_OCTAHEDRON2);
  test_pairs_of(HS_OCTAHEDRON3);
}
