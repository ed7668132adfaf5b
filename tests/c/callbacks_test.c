// What callers' functions may do, and what calls return when these do something
// else.
#include <stdlib.h>

#include "check.h"

enum { OBJECTS = 20000, VALUES = 6 };

static float objects[OBJECTS * VALUES];

// Calls the parts in any order, and not the first ones.
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

// Each part runs once, whatever the caller's function passes. The result does
// not depend on it.
static void test_run(void) {
#define CHECK_RUN_FAILS(call, start)    \
  CHECK((call) == HS_INVALID_ARGUMENT); \
  CHECK(strstr(hs_last_error(), start ": expected ") == hs_last_error())
  const size_t numbers[] = {0, 1, SIZE_MAX};
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  const hs_columns columns = hs_float_rows(objects, OBJECTS, VALUES);
  work threads = {0, 0, 0};
  hs_builder* builder = NULL;
  hs_bvh* right = NULL;
  hs_bvh* bvh = NULL;
  hs_pair_events* events = NULL;
  hs_pair_event_options options;
  const hs_id_pair* pairs = NULL;
  size_t count = 0;
  size_t left = 0;
  size_t i;
  random_bounds(HS_BOX3, OBJECTS, 0.05f, 17, objects);
  CHECK_OK(hs_bvh_create(&config, &columns, &right));
  config.run = run_one_number;
  for (i = 0; i < sizeof(numbers) / sizeof(numbers[0]); ++i) {
    config.run_context = (void*)&numbers[i];
    CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
    CHECK(have_same_bytes(bvh, right));
    hs_bvh_destroy(bvh);
    bvh = NULL;
  }
  config.run = run_too_often;
  CHECK_RUN_FAILS(hs_bvh_create(&config, &columns, &bvh),
                  "hs_bvh_create: config->run");
  config.run = run_backwards;
  config.run_context = &threads;
  CHECK_OK(hs_builder_create(&config, &builder));
  CHECK_OK(hs_builder_push(builder, &columns));
  threads.left_out = 1;
  CHECK_RUN_FAILS(hs_builder_finish(builder, &bvh),
                  "hs_builder_finish: config->run");
  CHECK(bvh == NULL);
  threads = (work){0, 0, 0};
  CHECK_OK(hs_builder_finish(builder, &bvh));
  CHECK(have_same_bytes(bvh, right));
  CHECK(threads.parts > threads.calls && threads.calls > 0);
  hs_builder_destroy(builder);
  hs_builder_destroy(NULL);

  threads = (work){0, 0, 0};
  CHECK_OK(hs_bvh_refit(bvh, &columns, run_backwards, &threads));
  CHECK(have_same_bytes(bvh, right));
  CHECK(threads.parts > threads.calls && threads.calls > 0);
  threads.left_out = 1;
  CHECK_RUN_FAILS(hs_bvh_refit(bvh, &columns, run_backwards, &threads),
                  "hs_bvh_refit: run");
  CHECK_RUN_FAILS(hs_bvh_rebuild(bvh, &config), "hs_bvh_rebuild: config->run");
  threads = (work){0, 0, 0};
  CHECK_OK(hs_bvh_refit(bvh, &columns, run_backwards, &threads));
  threads.calls = 0;
  CHECK_OK(hs_bvh_rebuild(bvh, &config));
  CHECK(threads.calls > 0);
  CHECK_OK(hs_bvh_verify(bvh));
  CHECK_OK(hs_pair_event_options_default(&options, sizeof(options)));
  options.run = run_backwards;
  options.run_context = &threads;
  CHECK_OK(hs_pair_events_create(NULL, &events));
  CHECK_OK(hs_pair_events_update(events, bvh, NULL));
  CHECK_OK(hs_pair_events_pairs(events, &pairs, &count));
  threads = (work){0, 0, 0};
  CHECK_OK(hs_pair_events_update(events, bvh, &options));
  CHECK(threads.calls > 0);
  threads.left_out = 1;
  CHECK_RUN_FAILS(hs_pair_events_update(events, bvh, &options),
                  "hs_pair_events_update: options->run");
  CHECK_OK(hs_pair_events_pairs(events, &pairs, &left));
  CHECK(left == count && count > 0);
  hs_pair_events_destroy(events);
  hs_bvh_destroy(bvh);
  hs_bvh_destroy(right);
  hs_bvh_destroy(NULL);
}

static void test_run_of_bodies(void) {
  static uint32_t ids[OBJECTS];
  hs_columns columns = hs_float_rows(objects, OBJECTS, VALUES);
  hs_broad_phase_config config;
  hs_update_options options;
  hs_broad_phase* bodies = NULL;
  work threads = {0, 0, 0};
  size_t i;
  int is_valid = 0;
  for (i = 0; i < OBJECTS; ++i) ids[i] = (uint32_t)i;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = HS_BOX3;
  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  CHECK(options.budget == SIZE_MAX);
  options.run = run_backwards;
  options.run_context = &threads;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &columns, NULL));
  CHECK_OK(hs_broad_phase_update_pairs(bodies, &options));
  CHECK(threads.calls > 0);
  threads.calls = 0;
  CHECK_OK(hs_broad_phase_rebuild(bodies, &options));
  CHECK(threads.calls > 0);
  threads.left_out = 1;
  columns = hs_float_rows(objects + VALUES, OBJECTS - 1, VALUES);
  CHECK_OK(hs_broad_phase_move(bodies, ids, &columns));
  CHECK_RUN_FAILS(hs_broad_phase_update_pairs(bodies, &options),
                  "hs_broad_phase_update_pairs: options->run");
  CHECK_OK(hs_broad_phase_validate(bodies, &is_valid));
  CHECK(is_valid);
  hs_broad_phase_destroy(bodies);
  hs_broad_phase_destroy(NULL);
}

static const float kFar[] = {9, 9, 9, 9};
static hs_broad_phase* bodies_2d;

// A callback moves the bodies, and its query goes on. Calls that wait for
// queries fail: broad_phase_test.cc makes them.
static hs_visit move_away(void* context, size_t query, const uint32_t* ids,
                          size_t count) {
#define CHECK_INSIDE(function, arguments)                                  \
  CHECK_INVALID(function arguments, #function                              \
                ": call: expected no query of the broad phase that still " \
                "runs on this thread: this call waits for queries, got a " \
                "call by the function of a query")
  hs_columns columns = hs_float_rows(kFar, count, 4);
  hs_broad_phase* copy = NULL;
  size_t n = 0;
  CHECK(query == 0);
  columns.stride = 0;
  *(size_t*)context += count;
  CHECK_OK(hs_broad_phase_move(bodies_2d, ids, &columns));
  columns.count = 1;
  CHECK_OK(hs_broad_phase_count(bodies_2d, &columns, NULL, &n));
  CHECK(n == count);
  CHECK_INSIDE(hs_broad_phase_update, (bodies_2d, NULL));
  CHECK_INSIDE(hs_broad_phase_erase, (bodies_2d, ids, 1));
  CHECK_INSIDE(hs_broad_phase_copy, (bodies_2d, &copy));
  CHECK(copy == NULL);
  return HS_CONTINUE;
}

static void test_calls_inside(void) {
  const float boxes[] = {0, 0, 1, 1};
  const uint32_t ids[] = {0, 1, 2};
  hs_broad_phase_config config;
  hs_columns columns = hs_float_rows(boxes, 3, 4);
  const hs_columns far = hs_float_rows(kFar, 1, 4);
  hs_body_masks masks[3];
  size_t calls = 0;
  size_t size = 0;
  columns.stride = 0;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = HS_BOX2;
  CHECK_OK(hs_broad_phase_create(&config, &bodies_2d));
  CHECK_OK(hs_broad_phase_insert(bodies_2d, ids, &columns, NULL));
  CHECK_OK(hs_broad_phase_get(bodies_2d, ids, 3, NULL, masks));
  CHECK(masks[2].category == UINT32_MAX &&
        masks[2].collides_with == UINT32_MAX);
  columns.count = 1;
  CHECK_OK(hs_broad_phase_probe(bodies_2d, &columns, NULL, move_away, &calls));
  CHECK(calls == 3);
  CHECK_OK(hs_broad_phase_count(bodies_2d, &columns, NULL, &size));
  CHECK(size == 0);
  CHECK_OK(hs_broad_phase_count(bodies_2d, &far, NULL, &size));
  CHECK(size == 3);
  CHECK_OK(hs_broad_phase_update(bodies_2d, NULL));
  hs_broad_phase_destroy(bodies_2d);
}

void test_callbacks(void) {
  test_run();
  test_run_of_bodies();
  test_calls_inside();
}
