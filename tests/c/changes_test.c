// Hierarchies that are pushed in batches, or change.
#include <math.h>
#include <stdlib.h>

#include "check.h"

enum { OBJECTS = 20000, VALUES = 8 };

static float objects[OBJECTS * VALUES];

static size_t count_of(const hs_bvh* bvh, const float* query, uint32_t mask) {
  const hs_columns asked = hs_float_rows(query, 1, 6);
  hs_query_options options;
  size_t count = 0;
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  options.mask = mask;
  CHECK_OK(hs_bvh_count(bvh, &asked, &options, &count));
  return count;
}

// Calls the parts in any order.
typedef struct work {
  size_t calls;
  size_t parts;
  size_t left_out;
} work;
static void run_backwards(void* context, size_t count, hs_part_function part,
                          void* of_part) {
  work* const its = context;
  size_t i;
  ++its->calls;
  its->parts += count;
  for (i = count; i > its->left_out; --i) part(of_part, i - 1);
}

// Calls the parts with numbers of other parts, or of none.
static void run_one_number(void* context, size_t count, hs_part_function part,
                           void* of_part) {
  size_t i;
  for (i = 0; i < count; ++i) part(of_part, *(const size_t*)context);
}
static void run_too_often(void* context, size_t count, hs_part_function part,
                          void* of_part) {
  size_t i;
  (void)context;
  for (i = 0; i < count + 3; ++i) part(of_part, i);
}

// Each part runs once, whatever the caller's function passes.
static void test_wrong_numbers(void) {
  const size_t numbers[] = {0, 1, SIZE_MAX};
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  const hs_columns columns = hs_float_rows(objects, OBJECTS, 6);
  hs_bvh* right = NULL;
  hs_bvh* bvh = NULL;
  const void* a = NULL;
  const void* b = NULL;
  size_t a_size = 0;
  size_t b_size = 0;
  size_t i;
  random_bounds(HS_BOX3, OBJECTS, 0.05f, 17, objects);
  CHECK_OK(hs_bvh_create(&config, &columns, &right));
  CHECK_OK(hs_bvh_blob(right, &a, &a_size));
  config.run = run_one_number;
  for (i = 0; i < sizeof(numbers) / sizeof(numbers[0]); ++i) {
    config.run_context = (void*)&numbers[i];
    CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
    CHECK_OK(hs_bvh_blob(bvh, &b, &b_size));
    CHECK(a_size == b_size && memcmp(a, b, a_size) == 0);
    hs_bvh_destroy(bvh);
    bvh = NULL;
  }
  config.run = run_too_often;
  CHECK(hs_bvh_create(&config, &columns, &bvh) == HS_INVALID_ARGUMENT);
  CHECK(strstr(hs_last_error(), "hs_bvh_create: config->run: expected ") ==
        hs_last_error());
  CHECK(bvh == NULL);
  hs_bvh_destroy(right);
}

// The same objects at once and in batches, of floats and of doubles, have the
// same bytes.
static void test_batches(hs_kind kind) {
  const size_t values = hs_bound_values(kind);
  const size_t half = OBJECTS / 2;
  double* const doubles = malloc(half * values * sizeof(double));
  work threads = {0, 0, 0};
  hs_bvh_config config = bvh_config_of(kind);
  hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  hs_builder* builder = NULL;
  hs_bvh* at_once = NULL;
  hs_bvh* built = NULL;
  const void* a = NULL;
  const void* b = NULL;
  size_t a_size = 0;
  size_t b_size = 0;
  size_t i;
  random_bounds(kind, OBJECTS, 0.05f, 10, objects);
  for (i = 0; i < half * values; ++i) {
    doubles[i] = (double)objects[half * values + i];
  }
  CHECK_OK(hs_bvh_create(&config, &columns, &at_once));
  config.run = run_backwards;
  config.run_context = &threads;
  CHECK_OK(hs_builder_create(&config, &builder));
  CHECK_OK(hs_builder_finish(builder, &built));
  CHECK_OK(hs_bvh_size(built, &i));
  CHECK(i == 0);
  hs_bvh_destroy(built);
  columns = hs_float_rows(objects, half, values);
  CHECK_OK(hs_builder_push(builder, &columns));
  columns = hs_double_rows(doubles, half, values);
  CHECK_OK(hs_builder_push(builder, &columns));
  CHECK_OK(hs_builder_finish(builder, &built));
  CHECK(threads.parts > threads.calls && threads.calls > 0);
  CHECK_OK(hs_bvh_blob(at_once, &a, &a_size));
  CHECK_OK(hs_bvh_blob(built, &b, &b_size));
  CHECK(a_size == b_size && memcmp(a, b, a_size) == 0);
  hs_bvh_destroy(built);

  // The other quality has another order.
  config.quality = HS_QUALITY_FAST;
  columns = hs_float_rows(objects, OBJECTS, values);
  CHECK_OK(hs_bvh_create(&config, &columns, &built));
  CHECK_OK(hs_bvh_blob(built, &b, &b_size));
  CHECK(a_size == b_size && memcmp(a, b, a_size) != 0);
  hs_bvh_destroy(built);
  columns = hs_double_rows(doubles, half, values);

  // Still there, and one more.
  columns.count = 1;
  CHECK_OK(hs_builder_push(builder, &columns));
  CHECK_OK(hs_builder_finish(builder, &built));
  CHECK_OK(hs_bvh_size(built, &i));
  CHECK(i == OBJECTS + 1);
  hs_bvh_destroy(built);
  threads.left_out = 1;
  built = NULL;
  CHECK(hs_builder_finish(builder, &built) == HS_INVALID_ARGUMENT);
  CHECK(strstr(hs_last_error(), "hs_builder_finish: config->run: expected") ==
        hs_last_error());
  CHECK(built == NULL);
  hs_builder_destroy(builder);
  hs_builder_destroy(NULL);
  hs_bvh_destroy(at_once);
  free(doubles);
}

static void test_ids(void) {
  const float near_boxes[] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};
  const double far_boxes[] = {10.1, 10, 10, 11, 11, 11.7};
  const float around_0[] = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
  const float around_far[] = {10, 10, 10, 12, 12, 12};
  const float everywhere[] = {-99, -99, -99, 99, 99, 99};
  const uint32_t masks[] = {1, 2};
  const uint32_t all_masks[] = {2, 0, 0};
  const uint32_t both[] = {0, 1};
  const uint32_t twice[] = {0, 1, 0, 1};
  const uint32_t wrong_then_right[] = {2, 1, 1, 2};
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  hs_columns columns = hs_float_rows(near_boxes, 2, 6);
  hs_bvh* bvh = NULL;
  uint32_t ids[2] = {9, 9};
  float record[12];
  float records[24];
  size_t size = 0;
  double ratio = 0;
  records[18] = -1;
  config.quality = HS_QUALITY_FAST;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  columns = hs_double_rows(far_boxes, 1, 6);
  CHECK_OK(hs_bvh_insert(bvh, &columns, ids));
  CHECK(ids[0] == 2 && count_of(bvh, around_far, ~0u) == 1);
  CHECK_OK(hs_bvh_get(bvh, ids, 1, record));
  // The nearest floats are 10.1000004 and 11.6999998.
  CHECK((double)record[0] < 10.1 && record[0] > 10.0999f);
  CHECK((double)record[5] > 11.7 && record[5] < 11.7001f);
  CHECK_OK(hs_bvh_get_all(bvh, records, 4));
  CHECK(memcmp(records, near_boxes, sizeof(near_boxes)) == 0);
  CHECK(memcmp(records + 12, record, 6 * sizeof(float)) == 0);
  CHECK(records[18] == -1);
  CHECK_OK(hs_bvh_erase(bvh, ids, 1));
  CHECK(count_of(bvh, around_far, ~0u) == 0);
  CHECK_OK(hs_bvh_get_all(bvh, records, 3));
  CHECK(memcmp(records, near_boxes, sizeof(near_boxes)) == 0);
  CHECK(records[12] == INFINITY && records[14] == INFINITY);
  CHECK(records[15] == -INFINITY && records[17] == -INFINITY);
  CHECK_OK(hs_bvh_size(bvh, &size));
  CHECK(size == 2);
  CHECK_OK(hs_bvh_id_limit(bvh, &size));
  CHECK(size == 3);

  ids[0] = 0;
  CHECK_OK(hs_bvh_set(bvh, ids, &columns));
  CHECK(count_of(bvh, around_far, ~0u) == 1);
  CHECK(count_of(bvh, around_0, ~0u) == 0);
  CHECK_OK(hs_bvh_set_masks(bvh, both, masks, 2));
  CHECK(count_of(bvh, around_far, 1) == 1);
  CHECK(count_of(bvh, everywhere, 2) == 1);
  // More masks than objects: the last one of an id counts.
  CHECK_OK(hs_bvh_set_masks(bvh, twice, wrong_then_right, 4));
  CHECK(count_of(bvh, around_far, 1) == 1);
  CHECK(count_of(bvh, everywhere, 2) == 1);
  // No list of ids, as of an empty vector, means no object.
  CHECK_OK(hs_bvh_set_masks(bvh, NULL, NULL, 0));
  CHECK_INVALID(hs_bvh_set_masks(bvh, NULL, masks, 1),
                "hs_bvh_set_masks: ids: expected a pointer, got null");
  CHECK(count_of(bvh, around_far, 1) == 1);
  CHECK(count_of(bvh, everywhere, 2) == 1);
  CHECK_INVALID(hs_bvh_set_all_masks(bvh, all_masks, 2),
                "hs_bvh_set_all_masks: masks: expected a mask for each id, at "
                "least 3, got 2");
  CHECK_OK(hs_bvh_set_all_masks(bvh, all_masks, 3));
  CHECK(count_of(bvh, around_far, 1) == 0);
  CHECK(count_of(bvh, everywhere, 2) == 1);
  CHECK(count_of(bvh, everywhere, ~0u) == 2);

  CHECK_OK(hs_bvh_rebuild(bvh, NULL));
  CHECK_OK(hs_bvh_id_limit(bvh, &size));
  CHECK(size == 2);
  columns = hs_float_rows(near_boxes, 2, 6);
  CHECK_OK(hs_bvh_refit(bvh, &columns, NULL, NULL));
  CHECK(count_of(bvh, around_0, ~0u) == 1);
  CHECK_OK(hs_bvh_cost_ratio(bvh, &ratio));
  CHECK(ratio == 1);
  CHECK_OK(hs_bvh_erase(bvh, both, 2));
  CHECK_OK(hs_bvh_id_limit(bvh, &size));
  CHECK(size == 0);
  hs_bvh_destroy(bvh);
}

static void test_work_of_changes(void) {
  const float everywhere[] = {-99, -99, -99, 99, 99, 99};
  const size_t values = 6;
  double* const doubles = malloc(OBJECTS * values * sizeof(double));
  work threads = {0, 0, 0};
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  hs_bvh* bvh = NULL;
  double ratio = 0;
  float before[6];
  float record[6];
  size_t i;
  random_bounds(HS_BOX3, OBJECTS, 0.01f, 11, objects);
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_bounds(bvh, before));
  // All objects get other places.
  for (i = 0; i < OBJECTS * values; ++i) {
    doubles[i] = (double)objects[(i + 6000) % (OBJECTS * values)];
  }
  columns = hs_double_rows(doubles, OBJECTS, values);
  config.run = run_backwards;
  config.run_context = &threads;
  CHECK_OK(hs_bvh_refit(bvh, &columns, run_backwards, &threads));
  CHECK(threads.parts > threads.calls && threads.calls > 0);
  CHECK_OK(hs_bvh_cost_ratio(bvh, &ratio));
  CHECK(ratio > 10);
  threads.left_out = 1;
  CHECK(hs_bvh_refit(bvh, &columns, run_backwards, &threads) ==
        HS_INVALID_ARGUMENT);
  CHECK(strstr(hs_last_error(), "hs_bvh_refit: run: expected ") ==
        hs_last_error());
  threads.left_out = 0;
  CHECK_OK(hs_bvh_refit(bvh, &columns, run_backwards, &threads));
  threads.calls = 0;
  CHECK_OK(hs_bvh_rebuild(bvh, &config));
  CHECK(threads.calls > 0);
  CHECK_OK(hs_bvh_cost_ratio(bvh, &ratio));
  CHECK(ratio == 1);
  CHECK_OK(hs_bvh_bounds(bvh, record));
  CHECK(memcmp(record, before, sizeof(record)) == 0);
  CHECK(count_of(bvh, everywhere, ~0u) == OBJECTS);
  hs_bvh_destroy(bvh);
  free(doubles);
}

static void test_simplex_records(void) {
  const float box[] = {0, 0, 1, 1};
  const uint32_t id = 0;
  float record[6];
  hs_columns columns = hs_float_rows(box, 1, 4);
  const hs_bvh_config config = bvh_config_of(HS_SIMPLEX2);
  hs_bvh* bvh = NULL;
  CHECK_OK(hs_bound_boxes(HS_SIMPLEX2, &columns, NULL, record, NULL));
  columns = hs_float_rows(record, 1, 6);
  // Objects have no maxima.
  columns.column[3] = columns.column[4] = columns.column[5] = NULL;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_get(bvh, &id, 1, record));
  CHECK(record[0] == 0 && record[2] == -2 && record[3] == INFINITY);
  memset(record, 0, sizeof(record));
  CHECK_OK(hs_bvh_get_all(bvh, record, 1));
  CHECK(record[0] == 0 && record[2] == -2 && record[3] == INFINITY);
  CHECK_OK(hs_bvh_insert(bvh, &columns, &(uint32_t){0}));
  hs_bvh_destroy(bvh);
}

// Under ids of the caller's, with gaps.
static void test_insert_as(void) {
  const uint32_t ids[] = {7, 300, 2};
  const uint32_t twice[] = {9, 9};
  const hs_bvh_config config = bvh_config_of(HS_BOX3);
  hs_columns columns = hs_float_rows(objects, 0, 6);
  hs_bvh* bvh = NULL;
  float records[18];
  uint32_t id = 0;
  size_t size = 0;
  size_t limit = 0;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  columns.count = 3;
  CHECK_OK(hs_bvh_insert_as(bvh, ids, &columns));
  CHECK_OK(hs_bvh_get(bvh, ids, 3, records));
  CHECK(memcmp(records, objects, sizeof(records)) == 0);
  CHECK(count_of(bvh, objects + 6, UINT32_MAX) > 0);
  columns.count = 1;
  CHECK(hs_bvh_insert_as(bvh, ids + 1, &columns) == HS_INVALID_ARGUMENT);
  columns.count = 2;
  CHECK(hs_bvh_insert_as(bvh, twice, &columns) == HS_INVALID_ARGUMENT);
  CHECK(hs_bvh_insert_as(bvh, NULL, &columns) == HS_INVALID_ARGUMENT);
  CHECK_OK(hs_bvh_size(bvh, &size));
  CHECK_OK(hs_bvh_id_limit(bvh, &limit));
  CHECK(size == 3 && limit == 301);
  // The BVH chooses an id that nobody has.
  columns.count = 1;
  CHECK_OK(hs_bvh_insert(bvh, &columns, &id));
  CHECK(id != 7 && id != 300 && id != 2);
  hs_bvh_destroy(bvh);
}

void test_changes(void) {
  int kind;
  for (kind = 0; kind < KINDS; ++kind) test_batches(kind_of(kind));
  test_wrong_numbers();
  test_insert_as();
  test_ids();
  test_work_of_changes();
  test_simplex_records();
}
