// Bounds of shapes, and the columns that they come in.
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

static void check_record(const float* record, const float* expected,
                         size_t values) {
  size_t v;
  for (v = 0; v < values; ++v) {
    if (record[v] == expected[v]) continue;
    fprintf(stderr, "value %zu: %g, expected %g\n", v, (double)record[v],
            (double)expected[v]);
    CHECK(record[v] == expected[v]);
  }
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
  size_t everything = 99;
  hs_columns columns = hs_float_rows(box, 1, 6);
  hs_bound_options options;
  CHECK_OK(hs_bound_options_default(&options, sizeof(options)));
  options.tightest = 1;
  CHECK_OK(
      hs_bound_boxes(HS_OCTAHEDRON3, &columns, &options, bounds, &everything));
  check_record(bounds, boxed, 8);
  CHECK(everything == 0);
  CHECK_OK(hs_bound_boxes(HS_SIMPLEX3, &columns, &options, bounds, NULL));
  check_record(bounds, boxed, 8);
  CHECK_OK(hs_bound_boxes(HS_BOX3, &columns, &options, bounds, NULL));
  check_record(bounds, box, 6);

  columns = hs_float_rows(sphere, 1, 4);
  CHECK_OK(hs_bound_spheres(HS_BOX3, &columns, &options, bounds, NULL));
  check_record(bounds, of_sphere, 6);
  columns = hs_float_rows(box, 1, 3);
  CHECK_OK(hs_bound_points(HS_OCTAHEDRON3, &columns, &options, bounds, NULL));
  check_record(bounds, of_point, 8);
  columns = hs_float_rows(triangle, 1, 9);
  CHECK_OK(
      hs_bound_triangles(HS_OCTAHEDRON3, &columns, &options, bounds, NULL));
  check_record(bounds, of_triangle, 8);
  columns = hs_float_rows(triangle, 3, 3);
  CHECK_OK(hs_bound_faces(HS_OCTAHEDRON3, &columns, face, 1, &options, bounds,
                          &everything));
  check_record(bounds, of_triangle, 8);
  CHECK_OK(hs_bound_point_sets(HS_OCTAHEDRON3, &columns, ends, 2, &options,
                               bounds, &everything));
  CHECK(bounds[0] == INFINITY && bounds[7] == -INFINITY && everything == 0);
  check_record(bounds + 8, of_triangle, 8);
}

// In 2 dimensions, doubles, and columns of which each has its own memory.
static void test_columns(void) {
  const double min_x[] = {0.1, 1, 2};
  const double min_y[] = {0, 0.1, 5};
  const double max_x[] = {0.1, 3, 4};
  const double max_y[] = {9, 0.7, 6};
  const double corners[] = {0.1, 0, 0.1, 9, 0.1, 1};
  const uint32_t face[] = {0, 1, 2};
  const size_t end = 3;
  float bounds[18];
  float others[6];
  hs_columns columns = hs_double_rows(NULL, 3, 0);
  size_t i;
  columns.stride = 1;
  columns.column[0] = min_x;
  columns.column[1] = min_y;
  columns.column[2] = max_x;
  columns.column[3] = max_y;
  CHECK_OK(hs_bound_boxes(HS_OCTAHEDRON2, &columns, NULL, bounds, NULL));
  // 0.1 is between two floats.
  CHECK((double)bounds[0] < 0.1 && (double)bounds[3] > 0.1);
  CHECK(nextafterf(bounds[0], 1) == bounds[3]);
  CHECK((double)bounds[2] <= -9.1 && (double)bounds[5] >= -0.1);
  CHECK(bounds[6] == 1 && (double)bounds[7] < 0.1 && bounds[9] == 3 &&
        (double)bounds[10] > 0.7);

  // The same triangle in three forms.
  columns = hs_double_rows(corners, 1, 6);
  CHECK_OK(hs_bound_triangles(HS_OCTAHEDRON2, &columns, NULL, bounds, NULL));
  columns = hs_double_rows(corners, 3, 2);
  CHECK_OK(
      hs_bound_faces(HS_OCTAHEDRON2, &columns, face, 1, NULL, others, NULL));
  check_record(others, bounds, 6);
  CHECK_OK(hs_bound_point_sets(HS_OCTAHEDRON2, &columns, &end, 1, NULL, others,
                               NULL));
  check_record(others, bounds, 6);

  // A point whose coordinates are at any places, with a stride of 0.
  columns = hs_float_rows(NULL, 3, 0);
  columns.column[0] = others + 4;
  columns.column[1] = others + 1;
  CHECK_OK(hs_bound_points(HS_BOX2, &columns, NULL, bounds, NULL));
  for (i = 0; i < 3; ++i) {
    CHECK(bounds[4 * i] == others[4] && bounds[4 * i + 3] == others[1]);
  }
}

static void test_bad_shapes(void) {
  const float boxes[] = {1, 1, 0,        0,        NAN,       0,
                         1, 1, INFINITY, INFINITY, -INFINITY, -INFINITY};
  const float sphere[] = {0, 0, -1};
  const float points[] = {0, 0, 1, 1, 2, 2};
  // Set 1 ends before it begins, set 2 begins there, set 3 ends too late, and
  // set 4 begins too late.
  const size_t ends[] = {3, 1, 2, 4, 2};
  const uint32_t faces[] = {0, 1, 3};
  float bounds[20];
  size_t everything = 0;
  size_t i;
  hs_bound_options options;
  hs_columns columns = hs_float_rows(boxes, 3, 4);
  CHECK_OK(hs_bound_options_default(&options, sizeof(options)));
  CHECK_OK(hs_bound_boxes(HS_BOX2, &columns, NULL, bounds, &everything));
  CHECK(everything == 2);
  CHECK(bounds[0] == -FLT_MAX && bounds[2] == FLT_MAX);
  CHECK(bounds[4] == -FLT_MAX && bounds[7] == FLT_MAX);
  CHECK(bounds[8] == INFINITY && bounds[10] == -INFINITY);
  options.empty_if_inverted = 1;
  options.tightest = 1;
  options.target = hs_target_name(0);
  CHECK_OK(hs_bound_boxes(HS_BOX2, &columns, &options, bounds, &everything));
  CHECK(everything == 1 && bounds[0] == INFINITY && bounds[2] == -INFINITY);

  columns = hs_float_rows(sphere, 1, 3);
  CHECK_OK(hs_bound_spheres(HS_BOX2, &columns, NULL, bounds, &everything));
  CHECK(everything == 1 && bounds[0] == -FLT_MAX);
  columns = hs_float_rows(points, 3, 2);
  CHECK_OK(
      hs_bound_faces(HS_BOX2, &columns, faces, 1, NULL, bounds, &everything));
  CHECK(everything == 1 && bounds[0] == -FLT_MAX);
  CHECK_OK(hs_bound_point_sets(HS_BOX2, &columns, ends, 5, NULL, bounds,
                               &everything));
  CHECK(everything == 3);
  for (i = 0; i < 5; ++i) {
    const float expected[] = {0, -FLT_MAX, 1, -FLT_MAX, -FLT_MAX};
    CHECK(bounds[4 * i] == expected[i]);
  }
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

// More sets than are bounded at a time.
static void test_many_sets(void) {
  enum { SETS = 700 };
  static double points[SETS * 2 * 2];
  static size_t ends[SETS];
  static float bounds[SETS * 4];
  hs_columns columns = hs_double_rows(points, SETS * 2, 2);
  size_t i;
  for (i = 0; i < SETS; ++i) {
    points[4 * i] = (double)i;
    points[4 * i + 2] = (double)i + 0.5;
    ends[i] = 2 * i + 2;
  }
  CHECK_OK(
      hs_bound_point_sets(HS_BOX2, &columns, ends, SETS, NULL, bounds, NULL));
  for (i = 0; i < SETS; ++i) {
    CHECK(bounds[4 * i] == (float)i && bounds[4 * i + 2] == (float)i + 0.5f);
  }
}

void test_bounds(void) {
  test_known_shapes();
  test_columns();
  test_bad_shapes();
  test_unsupported_columns();
  test_many_sets();
}
