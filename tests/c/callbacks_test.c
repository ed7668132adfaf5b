// What `run`, the caller's function that runs parts of a call, may do, and what
// calls return when it does something else.
#include "check.h"

enum { OBJECTS = 20000, VALUES = 6 };

static float objects[OBJECTS * VALUES];
static uint32_t ids[OBJECTS];

// Calls the parts in any order, and not the first ones.
typedef struct work {
  size_t calls;
  size_t left_out;
} work;
static void run_backwards(void* context, size_t count, hs_part_function part,
                          void* of_part) {
  work* const its = context;
  size_t i;
  ++its->calls;
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

#define CHECK_RUN_FAILS(call, start)    \
  CHECK((call) == HS_INVALID_ARGUMENT); \
  CHECK(strstr(hs_last_error(), start ": expected ") == hs_last_error())
// The call runs parts by `run`, fails if one is left out, and can be made
// again.
#define CHECK_RUN(call, start)  \
  threads = (work){0, 1};       \
  CHECK_RUN_FAILS(call, start); \
  threads = (work){0, 0};       \
  CHECK_OK(call);               \
  CHECK(threads.calls > 0)

// Each part runs once, whatever the caller's function passes. The result does
// not depend on it.
static void test_run(void) {
  const size_t numbers[] = {0, 1, SIZE_MAX};
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  const hs_columns columns = hs_float_rows(objects, OBJECTS, VALUES);
  work threads;
  hs_builder* builder = NULL;
  hs_bvh* const right = bvh_of(HS_BOX3, &columns);
  hs_bvh* bvh = NULL;
  hs_pair_events* events = NULL;
  hs_pair_event_options options;
  size_t i;
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
  CHECK(bvh == NULL);
  config.run = run_backwards;
  config.run_context = &threads;
  CHECK_OK(hs_builder_create(&config, &builder));
  CHECK_OK(hs_builder_push(builder, &columns));
  CHECK_RUN(hs_builder_finish(builder, &bvh), "hs_builder_finish: config->run");
  CHECK(have_same_bytes(bvh, right));
  CHECK_RUN(hs_bvh_refit(bvh, &columns, run_backwards, &threads),
            "hs_bvh_refit: run");
  CHECK(have_same_bytes(bvh, right));
  CHECK_RUN(hs_bvh_rebuild(bvh, &config), "hs_bvh_rebuild: config->run");
  CHECK_OK(hs_bvh_verify(bvh));
  CHECK_OK(hs_pair_event_options_default(&options, sizeof(options)));
  options.run = run_backwards;
  options.run_context = &threads;
  CHECK_OK(hs_pair_events_create(NULL, &events));
  CHECK_RUN(hs_pair_events_update(events, bvh, &options),
            "hs_pair_events_update: options->run");
  hs_pair_events_destroy(events);
  hs_builder_destroy(builder);
  hs_builder_destroy(NULL);
  hs_bvh_destroy(bvh);
  hs_bvh_destroy(right);
  hs_bvh_destroy(NULL);
}

static void test_run_of_bodies(void) {
  const hs_columns columns = hs_float_rows(objects, OBJECTS, VALUES);
  hs_broad_phase_config config;
  hs_update_options options;
  hs_broad_phase* bodies = NULL;
  work threads;
  size_t i;
  for (i = 0; i < OBJECTS; ++i) ids[i] = (uint32_t)i;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = HS_BOX3;
  CHECK_OK(hs_update_options_default(&options, sizeof(options)));
  CHECK(options.budget == SIZE_MAX);
  options.run = run_backwards;
  options.run_context = &threads;
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &columns, NULL));
  CHECK_RUN(hs_broad_phase_update_pairs(bodies, &options),
            "hs_broad_phase_update_pairs: options->run");
  CHECK_RUN(hs_broad_phase_rebuild(bodies, &options),
            "hs_broad_phase_rebuild: options->run");
  hs_broad_phase_destroy(bodies);
  hs_broad_phase_destroy(NULL);
}

void test_callbacks(void) {
  random_bounds(HS_BOX3, OBJECTS, 0.05f, 17, objects);
  test_run();
  test_run_of_bodies();
}
