// Bounds of shapes that a reader can check, and of shapes that are wrong.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "check.h"

void random_bounds(hs_kind kind, size_t count, float side, uint32_t seed,
                   float* bounds) {
  const size_t dims = dims_of(kind);
  float* const boxes = malloc(count * 2 * dims * sizeof(float));
  hs_columns columns = hs_float_rows(boxes, count, 2 * dims);
  size_t i;
  size_t k;
  for (i = 0; i < count; ++i) {
    for (k = 0; k < dims; ++k) {
      float* const box = boxes + i * 2 * dims;
      box[k] = random_float(&seed);
      box[dims + k] = box[k] + side * random_float(&seed);
    }
  }
  CHECK_OK(hs_bound_boxes(kind, &columns, NULL, bounds, NULL));
  free(boxes);
}

static void test_known_shapes(void) {
  const float box[] = {1, 2, 3, 4, 5, 6};
  const float sphere[] = {1, 2, 3, 0.5f};
  const float triangle[] = {0, 0, 0, 1, 0, 0, 0, 2, 0};
  const float boxed[] = {1, 2, 3, -15, 4, 5, 6, -6};
  const float of_triangle[] = {0, 0, 0, -2, 1, 2, 0, 0};
  const float of_point[] = {1, 2, 3, -6, 1, 2, 3, -6};
  const float of_sphere[] = {0.5f, 1.5f, 2.5f, 1.5f, 2.5f, 3.5f};
  const uint32_t face[] = {2, 1, 0};
  const size_t ends[] = {0, 3};
  float bounds[16];
  hs_columns columns = hs_float_rows(box, 1, 6);
  hs_bound_options options;
#define CHECK_BOUND(first, expected) \
  CHECK(memcmp(bounds + (first), expected, sizeof(expected)) == 0)
  CHECK_OK(hs_bound_options_default(&options, sizeof(options)));
  options.tightest = 1;
  CHECK_OK(hs_bound_boxes(HS_SIMPLEX3, &columns, &options, bounds, NULL));
  CHECK_BOUND(0, boxed);
  columns = hs_float_rows(sphere, 1, 4);
  CHECK_OK(hs_bound_spheres(HS_BOX3, &columns, &options, bounds, NULL));
  CHECK_BOUND(0, of_sphere);
  columns = hs_float_rows(box, 1, 3);
  CHECK_OK(hs_bound_points(HS_OCTAHEDRON3, &columns, &options, bounds, NULL));
  CHECK_BOUND(0, of_point);
  columns = hs_float_rows(triangle, 1, 9);
  CHECK_OK(
      hs_bound_triangles(HS_OCTAHEDRON3, &columns, &options, bounds, NULL));
  CHECK_BOUND(0, of_triangle);
  columns = hs_float_rows(triangle, 3, 3);
  CHECK_OK(hs_bound_faces(HS_OCTAHEDRON3, &columns, face, 1, &options, bounds,
                          NULL));
  CHECK_BOUND(0, of_triangle);
  CHECK_OK(hs_bound_point_sets(HS_OCTAHEDRON3, &columns, ends, 2, &options,
                               bounds, NULL));
  CHECK(bounds[0] == INFINITY && bounds[7] == -INFINITY);
  CHECK_BOUND(8, of_triangle);
}

// Set 1 ends before it begins, set 2 begins there, set 3 ends too late, and
// set 4 begins too late.
static void test_bad_sets(void) {
  const float points[] = {0, 0, 1, 1, 2, 2};
  const size_t ends[] = {3, 1, 2, 4, 2};
  const float firsts[] = {0, -FLT_MAX, 1, -FLT_MAX, -FLT_MAX};
  const hs_columns columns = hs_float_rows(points, 3, 2);
  float bounds[20];
  size_t everything = 0;
  size_t i;
  CHECK_OK(hs_bound_point_sets(HS_BOX2, &columns, ends, 5, NULL, bounds,
                               &everything));
  CHECK(everything == 3);
  for (i = 0; i < 5; ++i) CHECK(bounds[4 * i] == firsts[i]);
  CHECK(bounds[8 + 2] == 1);
}

// Points whose coordinates are apart, and with a stride.
static void test_unsupported_columns(void) {
  const float rows[] = {0, 9, 1, 2, 9, 3};
  const size_t end = 2;
  float bounds[8];
  hs_columns columns = hs_float_rows(rows, 2, 3);
  columns.column[1] = rows + 2;
  CHECK_FAILS(
      hs_bound_point_sets(HS_BOX2, &columns, &end, 1, NULL, bounds, NULL),
      HS_UNSUPPORTED,
      "hs_bound_point_sets: points: expected adjacent coordinates or a "
      "stride of 1, got columns apart with a stride of 3: copy the "
      "points");
  // Each for itself they are bounded.
  CHECK_OK(hs_bound_points(HS_BOX2, &columns, NULL, bounds, NULL));
  CHECK(bounds[0] == 0 && bounds[1] == 1);
}

void test_bounds(void) {
  test_known_shapes();
  test_bad_sets();
  test_unsupported_columns();
}
