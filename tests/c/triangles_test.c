// Triangles in a BVH: each call against the same over all triangles. The tests
// of triangles.h compare a triangle with exact numbers.
#include <math.h>
#include <stdlib.h>

#include "check.h"

enum { TRIANGLES = 3000, RAYS = 500 };

static float triangles[TRIANGLES * 9];
static float rays[RAYS * 7];

static hs_bvh* make_bvh(size_t count) {
  const hs_columns columns = hs_float_rows(triangles, count, 9);
  const hs_bvh_config config = bvh_config_of(HS_BOX3);
  float* const boxes = malloc(count * 6 * sizeof(float));
  const hs_columns objects = hs_float_rows(boxes, count, 6);
  hs_bvh* bvh = NULL;
  CHECK_OK(hs_bound_triangles(HS_BOX3, &columns, NULL, boxes, NULL));
  CHECK_OK(hs_bvh_create(&config, &objects, &bvh));
  free(boxes);
  return bvh;
}

static void make_scene(void) {
  uint32_t state = 7;
  size_t i;
  size_t k;
  for (i = 0; i < TRIANGLES; ++i) {
    float* const its = triangles + 9 * i;
    for (k = 0; k < 9; ++k) {
      its[k] = (k < 3 ? 0.9f * random_float(&state) : its[k % 3]) +
               0.1f * random_float(&state);
    }
    // A triangle twice: the least id is found.
    if (i % 10 == 9) memcpy(its, its - 9, 9 * sizeof(float));
  }
  for (i = 0; i < RAYS; ++i) {
    for (k = 0; k < 6; ++k)
      rays[7 * i + k] = random_float(&state) - (k < 3 ? 0.0f : 0.5f);
    rays[7 * i + 6] = i % 4 == 0 ? 0.5f : INFINITY;
  }
}

typedef struct hits {
  uint32_t* counts;  // of each triangle
  size_t ray;
  float most;
} hits;
static float count_hit(void* context, size_t ray, uint32_t id, float t) {
  hits* const its = context;
  its->ray = ray;
  ++its->counts[id];
  return t < its->most ? INFINITY : -1.0f;
}

static void test_rays(const hs_bvh* bvh, const hs_columns* columns) {
  static uint32_t ids[RAYS];
  static float ts[RAYS];
  static uint32_t counts[TRIANGLES];
  const hs_columns all = hs_float_rows(rays, RAYS, 7);
  hs_bvh* const one_of = make_bvh(1);
  hits its = {counts, 0, INFINITY};
  size_t found = 0;
  size_t i;
  uint32_t id;
  CHECK_OK(hs_bvh_raycast_triangles(bvh, &all, columns, NULL, ids, ts));
  for (i = 0; i < RAYS; ++i) {
    const hs_columns ray = hs_float_rows(rays + 7 * i, 1, 7);
    uint32_t first = HS_NO_ID;
    float least = INFINITY;
    uint32_t again = 0;
    memset(counts, 0, sizeof(counts));
    CHECK_OK(hs_bvh_raycast_triangles_each(bvh, &ray, columns, NULL, count_hit,
                                           &its));
    for (id = 0; id < TRIANGLES; ++id) {
      // A BVH of one box of everything is asked for the triangle alone.
      const hs_columns alone = hs_float_rows(triangles + 9 * id, 1, 9);
      float t = INFINITY;
      uint32_t hit = HS_NO_ID;
      float box[6] = {-9, -9, -9, 9, 9, 9};
      const hs_columns of_box = hs_float_rows(box, 1, 6);
      if (i >= 40) break;
      {
        const uint32_t object = 0;
        CHECK_OK(hs_bvh_set(one_of, &object, &of_box));
      }
      CHECK_OK(hs_bvh_raycast_triangles(one_of, &ray, &alone, NULL, &hit, &t));
      CHECK(counts[id] == (hit == 0 ? 1u : 0u));
      if (t < least) {
        least = t;
        first = id;
      }
    }
    if (i < 40) CHECK(first == ids[i] && least == ts[i]);
    for (id = 0; id < TRIANGLES; ++id) again += counts[id];
    CHECK((again == 0) == (ids[i] == HS_NO_ID));
    found += again;
  }
  CHECK(found > RAYS);
  // A negative limit ends the cast of one ray, and not of the others.
  memset(counts, 0, sizeof(counts));
  its.most = -1.0f;
  CHECK_OK(
      hs_bvh_raycast_triangles_each(bvh, &all, columns, NULL, count_hit, &its));
  for (i = 0, found = 0; i < TRIANGLES; ++i) found += counts[i];
  for (i = 0; i < RAYS; ++i) found -= ids[i] != HS_NO_ID ? 1 : 0;
  CHECK(found == 0);
  // A mask that nothing has.
  {
    hs_query_options options;
    CHECK_OK(hs_query_options_default(&options, sizeof(options)));
    options.mask = 0;
    CHECK_OK(hs_bvh_raycast_triangles(bvh, &all, columns, &options, ids, NULL));
    for (i = 0; i < RAYS; ++i) CHECK(ids[i] == HS_NO_ID);
  }
  hs_bvh_destroy(one_of);
}

static void test_points(const hs_bvh* bvh, const hs_columns* columns) {
  static uint32_t ids[RAYS];
  static float closest[3 * RAYS];
  static float distances[RAYS];
  hs_columns points = hs_float_rows(rays, RAYS, 7);
  hs_bvh* const one_of = make_bvh(1);
  size_t i;
  uint32_t id;
  CHECK_OK(hs_bvh_closest_points(bvh, &points, columns, 0.05f, NULL, ids,
                                 closest, distances));
  for (i = 0; i < 60; ++i) {
    const hs_columns point = hs_float_rows(rays + 7 * i, 1, 3);
    uint32_t first = HS_NO_ID;
    float least = INFINITY;
    for (id = 0; id < TRIANGLES; ++id) {
      const hs_columns alone = hs_float_rows(triangles + 9 * id, 1, 9);
      float distance;
      uint32_t object = 0;
      float box[6] = {-9, -9, -9, 9, 9, 9};
      const hs_columns of_box = hs_float_rows(box, 1, 6);
      if (id == 0) CHECK_OK(hs_bvh_set(one_of, &object, &of_box));
      CHECK_OK(hs_bvh_closest_points(one_of, &point, &alone, 0.05f, NULL,
                                     &object, NULL, &distance));
      if (distance < least) {
        least = distance;
        first = id;
      }
    }
    CHECK(ids[i] == first && distances[i] == least);
    CHECK(isnan(closest[3 * i]) == (first == HS_NO_ID));
  }
  hs_bvh_destroy(one_of);
}

void test_triangles(void) {
  const hs_columns columns = hs_float_rows(triangles, TRIANGLES, 9);
  const hs_columns few = hs_float_rows(triangles, TRIANGLES - 1, 9);
  const hs_columns all = hs_float_rows(rays, RAYS, 7);
  const hs_columns nothing = hs_float_rows(rays, 0, 4);
  hs_columns doubles = columns;
  const hs_bvh_config flat_config = bvh_config_of(HS_BOX2);
  hs_bvh* flat = NULL;
  hs_bvh* bvh;
  uint32_t ids[RAYS];
  make_scene();
  bvh = make_bvh(TRIANGLES);
  test_rays(bvh, &columns);
  test_points(bvh, &columns);

  CHECK_OK(hs_bvh_create(&flat_config, &nothing, &flat));
  doubles.type = HS_FLOAT64;
  INVALID(hs_bvh_raycast_triangles, (flat, &all, &columns, NULL, ids, NULL),
          "bvh: expected 3 dimensions, got 2");
  INVALID(hs_bvh_raycast_triangles, (bvh, &all, &few, NULL, ids, NULL),
          "triangles->count: expected at least hs_bvh_id_limit(), 3000, got "
          "2999");
  INVALID(hs_bvh_closest_points,
          (bvh, &all, &columns, -1.0f, NULL, ids, NULL, NULL),
          "max_distance: expected a number that is not negative, got -1");
  CHECK(hs_bvh_raycast_triangles(bvh, &all, &doubles, NULL, ids, NULL) ==
        HS_INVALID_ARGUMENT);
  CHECK(hs_bvh_raycast_triangles(bvh, NULL, &columns, NULL, ids, NULL) ==
        HS_INVALID_ARGUMENT);
  CHECK(hs_bvh_raycast_triangles_each(bvh, &all, &columns, NULL, NULL, NULL) ==
        HS_INVALID_ARGUMENT);
  hs_bvh_destroy(flat);
  hs_bvh_destroy(bvh);
}
