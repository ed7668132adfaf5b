// What a call says of an argument that is wrong, and that it changes nothing.
#include <math.h>

#include "check.h"

static const float kBoxes[] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};

// Programs that were compiled with an older header pass these structs.
#if UINTPTR_MAX == UINT64_MAX
#define CHECK_OFFSET(type, field, offset) \
  _Static_assert(offsetof(type, field) == (offset), #type)
CHECK_OFFSET(hs_allocator, allocate, 0);
CHECK_OFFSET(hs_allocator, deallocate, 8);
CHECK_OFFSET(hs_allocator, context, 16);
CHECK_OFFSET(hs_columns, type, 0);
CHECK_OFFSET(hs_columns, count, 8);
CHECK_OFFSET(hs_columns, stride, 16);
CHECK_OFFSET(hs_columns, column, 24);
_Static_assert(sizeof(hs_columns) == 96, "hs_columns");
CHECK_OFFSET(hs_bound_options, tightest, 8);
CHECK_OFFSET(hs_bound_options, empty_if_inverted, 12);
CHECK_OFFSET(hs_bound_options, target, 16);
CHECK_OFFSET(hs_scan_config, kind, 8);
CHECK_OFFSET(hs_scan_config, bits, 12);
CHECK_OFFSET(hs_scan_config, allocator, 16);
CHECK_OFFSET(hs_scan_options, begin, 8);
CHECK_OFFSET(hs_scan_options, end, 16);
CHECK_OFFSET(hs_scan_options, skip, 24);
CHECK_OFFSET(hs_scan_options, target, 32);
CHECK_OFFSET(hs_bvh_config, kind, 8);
CHECK_OFFSET(hs_bvh_config, quality, 12);
CHECK_OFFSET(hs_bvh_config, target, 16);
CHECK_OFFSET(hs_bvh_config, run, 24);
CHECK_OFFSET(hs_bvh_config, run_context, 32);
CHECK_OFFSET(hs_bvh_config, allocator, 40);
CHECK_OFFSET(hs_query_options, mask, 8);
CHECK_OFFSET(hs_query_options, shape, 12);
CHECK_OFFSET(hs_query_options, skip, 16);
CHECK_OFFSET(hs_query_options, target, 24);
CHECK_OFFSET(hs_query_options, exclusive, 32);
CHECK_OFFSET(hs_id_pair, b, 4);
CHECK_OFFSET(hs_pair_options, mask, 8);
CHECK_OFFSET(hs_pair_options, margin, 12);
CHECK_OFFSET(hs_pair_options, skip, 16);
CHECK_OFFSET(hs_pair_options, begin, 24);
CHECK_OFFSET(hs_pair_options, end, 32);
CHECK_OFFSET(hs_pair_options, target, 40);
CHECK_OFFSET(hs_pair_options, wanted, 48);
CHECK_OFFSET(hs_body_masks, collides_with, 4);
CHECK_OFFSET(hs_broad_phase_config, kind, 8);
CHECK_OFFSET(hs_broad_phase_config, moves_wait_for_update, 12);
CHECK_OFFSET(hs_broad_phase_config, caller_locks, 16);
CHECK_OFFSET(hs_broad_phase_config, keep, 24);
CHECK_OFFSET(hs_broad_phase_config, keep_context, 32);
CHECK_OFFSET(hs_broad_phase_config, allocator, 40);
CHECK_OFFSET(hs_update_options, budget, 8);
CHECK_OFFSET(hs_update_options, run, 16);
CHECK_OFFSET(hs_update_options, run_context, 24);
CHECK_OFFSET(hs_body_statistics, bodies, 8);
CHECK_OFFSET(hs_body_statistics, pairs, 16);
CHECK_OFFSET(hs_body_statistics, bytes, 24);
CHECK_OFFSET(hs_body_statistics, cost_ratio, 32);
#endif

static void test_structs(void) {
  struct {
    hs_query_options known;
    unsigned char unknown[8];
  } newer;
  hs_query_options options;
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  const hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_bvh* bvh = NULL;
  size_t total = 0;
  uint32_t ids[2];
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));

  // An older program: the target is that of the library.
  memset(&options, 0xFF, sizeof(options));
  CHECK_OK(
      hs_query_options_default(&options, offsetof(hs_query_options, target)));
  CHECK(options.struct_size == offsetof(hs_query_options, target));
  CHECK(options.mask == 0xFFFFFFFF && options.skip == 0);
  options.skip = 1;
  CHECK_OK(hs_bvh_query(bvh, &columns, &options, ids, 2, NULL, &total));
  CHECK(total == 2);
  options.struct_size = offsetof(hs_query_options, skip);
  options.mask = 0;
  CHECK_OK(hs_bvh_query(bvh, &columns, &options, ids, 2, NULL, &total));
  CHECK(total == 0);

  // A newer one: what the library does not know is 0.
  CHECK_OK(hs_query_options_default(&newer.known, sizeof(newer)));
  CHECK(newer.known.struct_size == sizeof(newer) && newer.unknown[7] == 0);
  CHECK_OK(hs_bvh_query(bvh, &columns, &newer.known, ids, 2, NULL, &total));
  CHECK(total == 2);
  newer.unknown[3] = 1;
  CHECK(hs_bvh_query(bvh, &columns, &newer.known, ids, 2, NULL, &total) ==
        HS_INVALID_ARGUMENT);
  CHECK(strstr(hs_last_error(), "use a newer library") != NULL);

  memset(&options, 0, sizeof(options));
  CHECK_INVALID(hs_bvh_query(bvh, &columns, &options, ids, 2, NULL, &total),
                "hs_bvh_query: options->struct_size: expected sizeof *options, "
                "as the function ..._default() sets it, got 0");
  options.struct_size = sizeof(options) - 1;
  CHECK_INVALID(hs_bvh_query(bvh, &columns, &options, ids, 2, NULL, &total),
                "hs_bvh_query: options->struct_size: expected a multiple of 4, "
                "as the function ..._default() sets it, got 39");
  CHECK_INVALID(hs_bvh_config_default(NULL, sizeof(config)),
                "hs_bvh_config_default: the struct: expected a pointer, got "
                "null");
  CHECK_INVALID(hs_bvh_config_default(
                    (hs_bvh_config*)(void*)((char*)&newer + 1), sizeof(newer)),
                "hs_bvh_config_default: the struct: expected memory aligned to "
                "8 bytes, got a misaligned pointer");
  CHECK_INVALID(
      hs_bvh_query(bvh, &columns, (hs_query_options*)(void*)((char*)&newer + 4),
                   ids, 2, NULL, &total),
      "hs_bvh_query: options: expected memory aligned to 8 bytes, "
      "got a misaligned pointer");
  CHECK_INVALID(hs_pair_options_default((hs_pair_options*)(void*)&newer, 0),
                "hs_pair_options_default: struct_size: expected the sizeof of "
                "the struct, got 0");
  hs_bvh_destroy(bvh);
}

static void test_columns(void) {
  const hs_bvh_config config = bvh_config_of(HS_BOX3);
  hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  size_t size = 0;
  CHECK_INVALID(hs_bvh_create(&config, NULL, &bvh),
                "hs_bvh_create: objects: expected a pointer, got null");
  columns.column[4] = NULL;
  CHECK_INVALID(hs_bvh_create(&config, &columns, &bvh),
                "hs_bvh_create: objects->column[4]: expected a pointer, got "
                "null");
  columns.column[4] = (const char*)kBoxes + 1;
  CHECK_INVALID(hs_bvh_create(&config, &columns, &bvh),
                "hs_bvh_create: objects->column[4]: expected memory aligned to "
                "4 bytes, got a misaligned pointer");
  columns = hs_float_rows(kBoxes, 2, 6);
  columns.type = (hs_scalar)2;
  CHECK_INVALID(hs_bvh_create(&config, &columns, &bvh),
                "hs_bvh_create: objects->type: expected an enumerator of "
                "hs_scalar, got 2");
  columns = hs_float_rows(kBoxes, SIZE_MAX / 6, 6);
  CHECK(hs_bvh_create(&config, &columns, &bvh) == HS_INVALID_ARGUMENT);
  CHECK(strstr(hs_last_error(), "hs_bvh_create: objects->count: expected") ==
        hs_last_error());
  columns.stride = 0;
  CHECK(hs_bvh_create(&config, &columns, &bvh) == HS_INVALID_ARGUMENT);
  // Copies of one record.
  columns.count = 1000;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_size(bvh, &size));
  CHECK(size == 1000);
  hs_bvh_destroy(bvh);
  bvh = NULL;
  // So many fit the address space, if all are one record.
  columns.count = (size_t)1 << 31;
  CHECK(hs_bvh_create(&config, &columns, &bvh) == HS_INVALID_ARGUMENT);
  CHECK_INVALID(hs_bvh_create(&config, &columns, &bvh),
                "hs_bvh_create: objects: expected fewer than 2^31 objects in "
                "all, got 2147483648");
  CHECK(bvh == NULL);
  // No copy is made first.
  CHECK_OK(hs_builder_create(&config, &builder));
  CHECK_INVALID(hs_builder_push(builder, &columns),
                "hs_builder_push: objects: expected fewer than 2^31 objects in "
                "all, got 2147483648");
  hs_builder_destroy(builder);
  // The stride of one record is not used.
  columns.count = 1;
  columns.stride = SIZE_MAX;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  hs_bvh_destroy(bvh);
}

static void test_configurations(void) {
  const hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_bvh_config config = bvh_config_of((hs_kind)0);
  hs_scan_config scan_config = scan_config_of(HS_BOX3, 9);
  hs_bvh* bvh = NULL;
  hs_builder* builder = NULL;
  hs_scan* scan = NULL;
  float bounds[8];
  CHECK(hs_bound_values((hs_kind)7) == 0);
  CHECK_INVALID(
      hs_bvh_create(&config, &columns, &bvh),
      "hs_bvh_create: config->kind: expected an enumerator of hs_kind, got "
      "0");
  CHECK_INVALID(hs_bound_boxes((hs_kind)-1, &columns, NULL, bounds, NULL),
                "hs_bound_boxes: kind: expected an enumerator of hs_kind, got "
                "-1");
  CHECK_INVALID(hs_bvh_create(NULL, &columns, &bvh),
                "hs_bvh_create: config: expected a pointer, got null");
  config.kind = HS_BOX3;
  config.quality = (hs_quality)2;
  CHECK_INVALID(hs_builder_create(&config, &builder),
                "hs_builder_create: config->quality: expected an enumerator of "
                "hs_quality, got 2");
  config.quality = HS_QUALITY_HIGH;
  config.target = "avx9";
  CHECK_INVALID(hs_bvh_create(&config, &columns, &bvh),
                "hs_bvh_create: config->target: expected null or a name of "
                "hs_target_name(), got \"avx9\"");
  config.target = NULL;
  memcpy(&config.allocator.context, &scan, sizeof(scan));
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  hs_bvh_destroy(bvh);
  CHECK_INVALID(hs_scan_create(&scan_config, &columns, &scan),
                "hs_scan_create: config->bits: expected 0, 8 or 16, got 9");
  CHECK_INVALID(hs_bvh_create(&config, &columns, NULL),
                "hs_bvh_create: bvh: expected a pointer, got null");
  CHECK(scan == NULL && builder == NULL);
}

static void* no_memory(void* context, size_t bytes, size_t alignment) {
  (void)context;
  (void)bytes;
  (void)alignment;
  return NULL;
}

static void test_allocators(void) {
  const hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  hs_bvh* bvh = NULL;
  config.allocator.allocate = no_memory;
  CHECK_INVALID(hs_bvh_create(&config, &columns, &bvh),
                "hs_bvh_create: config->allocator: expected both functions or "
                "neither, got allocate alone");
  CHECK(bvh == NULL);
}

static hs_visit no_ids(void* context, size_t query, const uint32_t* ids,
                       size_t count) {
  (void)context;
  (void)query;
  (void)ids;
  (void)count;
  return HS_CONTINUE;
}

static void test_handles_and_outputs(void) {
  const hs_bvh_config config = bvh_config_of(HS_BOX3);
  const hs_bvh_config others = bvh_config_of(HS_BOX2);
  const hs_bvh_config simplices = bvh_config_of(HS_SIMPLEX2);
  const hs_scan_config scan_config = scan_config_of(HS_BOX3, 0);
  const hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  const hs_columns one = hs_float_rows(kBoxes, 1, 6);
  float ray[] = {0, 0, 0, 1, 0, 0, -1.0000001f};
  const float inverted[] = {INFINITY,  INFINITY,  INFINITY, -INFINITY,
                            -INFINITY, -INFINITY, NAN,      2,
                            0,         0,         1,        0};
  const hs_columns inverted_boxes = hs_float_rows(inverted, 2, 6);
  const double double_ray[] = {0, 0, 0, 1, 0, 0, 1};
  hs_columns rays = hs_float_rows(ray, 1, 7);
  hs_bound_options bound_options;
  hs_pair_options pair_options;
  hs_query_options options;
  hs_scan_options scan_options;
  float bounds[12];
  hs_bvh* bvh = NULL;
  hs_bvh* other = NULL;
  hs_bvh* simplex = NULL;
  hs_scan* scan = NULL;
  size_t total = 0;
  uint32_t ids[4] = {0, 7, 0, 0};
  uint64_t word = 0;
  hs_id_pair pair;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_create(&others, &columns, &other));
  CHECK_OK(hs_bvh_create(&simplices, &columns, &simplex));
  CHECK_OK(hs_scan_create(&scan_config, &columns, &scan));

  CHECK_INVALID(hs_bvh_query(NULL, &columns, NULL, ids, 4, NULL, &total),
                "hs_bvh_query: bvh: expected a pointer, got null");
  CHECK_INVALID(hs_bvh_query(bvh, &columns, NULL, NULL, 4, NULL, &total),
                "hs_bvh_query: ids: expected a pointer, got null");
  CHECK_INVALID(hs_bvh_query(bvh, &columns, NULL, ids, 4, NULL, NULL),
                "hs_bvh_query: total: expected a pointer, got null");
  CHECK_INVALID(hs_bvh_query(bvh, &columns, NULL, ids, SIZE_MAX, NULL, &total),
                "hs_bvh_query: ids: expected a size that fits the address "
                "space, got 18446744073709551615 elements");
  CHECK_INVALID(hs_bvh_probe(bvh, &columns, NULL, NULL, NULL),
                "hs_bvh_probe: function: expected a pointer, got null");
  CHECK_INVALID(hs_bvh_probe(NULL, &columns, NULL, no_ids, NULL),
                "hs_bvh_probe: bvh: expected a pointer, got null");
  CHECK_INVALID(hs_bvh_erase(bvh, ids, 2),
                "hs_bvh_erase: ids[1]: expected the id of an object, got 7");
  CHECK(strcmp(hs_last_error_argument(), "ids[1]") == 0);
  CHECK(strcmp(hs_last_error_reason(), "expected the id of an object, got 7") ==
        0);
  CHECK_INVALID(hs_bvh_set(bvh, ids, &columns),
                "hs_bvh_set: ids[1]: expected the id of an object, got 7");
  CHECK_OK(hs_bvh_size(bvh, &total));
  CHECK(total == 2);
  CHECK_INVALID(hs_bvh_refit(bvh, &one, NULL, NULL),
                "hs_bvh_refit: objects: expected a bound for each id, at least "
                "2, got 1");
  CHECK_INVALID(hs_bvh_get_all(bvh, bounds, 1),
                "hs_bvh_get_all: room: expected at least hs_bvh_id_limit(), 2, "
                "got 1");
  CHECK_INVALID(hs_bvh_reserve(bvh, (size_t)1 << 31),
                "hs_bvh_reserve: objects: expected fewer than 2^31 objects in "
                "all, got 2147483648");
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  options.exclusive = 1;
  CHECK_INVALID(
      hs_bvh_nearest_to_boxes(simplex, &columns, 1, 1, &options, ids, NULL),
      "hs_bvh_nearest_to_boxes: options->exclusive: expected 0, as the BVH is "
      "not of boxes, got 1");
  CHECK_INVALID(
      hs_bvh_nearest_to_points(bvh, &columns, 1, NAN, NULL, ids, NULL),
      "hs_bvh_nearest_to_points: max_distance: expected a number that is not "
      "negative, got nan");
  CHECK_INVALID(
      hs_bvh_nearest_to_boxes(bvh, &columns, SIZE_MAX, 1, NULL, ids, NULL),
      "hs_bvh_nearest_to_boxes: k: expected rows that fit the address space, "
      "got 18446744073709551615 for each of 2 queries");
  CHECK_INVALID(
      hs_bvh_nearest_to_boxes(bvh, &inverted_boxes, 1, 1, NULL, ids, NULL),
      "hs_bvh_nearest_to_boxes: boxes: expected minima that are not above the "
      "maxima, got 2 and 1 on axis 1 of box 1");
  CHECK_INVALID(hs_bound_boxes(HS_BOX3, &columns, NULL, bounds,
                               (size_t*)(void*)((char*)&total + 1)),
                "hs_bound_boxes: everything: expected memory aligned to 8 "
                "bytes, got a misaligned pointer");
  CHECK_INVALID(hs_bvh_raycast(bvh, &rays, 0, NULL, ids, NULL),
                "hs_bvh_raycast: rays->column[6]: expected limits of t that "
                "are not negative, got -1.0000001 of ray 0");
  ray[6] = 1;
  CHECK_INVALID(hs_bvh_raycast(bvh, &rays, -1, NULL, ids, NULL),
                "hs_bvh_raycast: radius: expected a number that is not "
                "negative, got -1");
  rays = hs_double_rows(double_ray, 1, 7);
  CHECK_INVALID(hs_bvh_raycast(bvh, &rays, 0, NULL, ids, NULL),
                "hs_bvh_raycast: rays->type: expected HS_FLOAT32, as these "
                "cannot be rounded outward, got HS_FLOAT64");
  CHECK(strcmp(hs_last_error_argument(), "rays->type") == 0);
  CHECK_INVALID(hs_bvh_raycast_each(bvh, &rays, 0, NULL, NULL, NULL),
                "hs_bvh_raycast_each: function: expected a pointer, got null");

  CHECK_INVALID(hs_bvh_join(bvh, other, NULL, &pair, 1, &total),
                "hs_bvh_join: b: expected a BVH of the kind of `a`, got "
                "another kind");
  CHECK_INVALID(hs_bvh_pairs(simplex, NULL, &pair, 1, &total),
                "hs_bvh_pairs: expected BVHs of boxes or octahedra, got "
                "simplices, which have no planes that face each other");
  CHECK(strcmp(hs_last_error_argument(), "") == 0);
  CHECK_OK(hs_pair_options_default(&pair_options, sizeof(pair_options)));
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  CHECK_OK(hs_bound_options_default(&bound_options, sizeof(bound_options)));
  CHECK_OK(hs_scan_options_default(&scan_options, sizeof(scan_options)));
  options.target = pair_options.target = "x";
  bound_options.target = scan_options.target = "x";
  CHECK_INVALID(hs_bvh_count(bvh, &columns, &options, &total),
                "hs_bvh_count: options->target: expected null or a name of "
                "hs_target_name(), got \"x\"");
  CHECK_INVALID(hs_bvh_pairs(bvh, &pair_options, &pair, 1, &total),
                "hs_bvh_pairs: options->target: expected null or a name of "
                "hs_target_name(), got \"x\"");
  CHECK_INVALID(hs_bound_boxes(HS_BOX3, &columns, &bound_options, bounds, NULL),
                "hs_bound_boxes: options->target: expected null or a name of "
                "hs_target_name(), got \"x\"");
  CHECK_INVALID(hs_scan_counts(scan, &columns, &scan_options, &total),
                "hs_scan_counts: options->target: expected null or a name of "
                "hs_target_name(), got \"x\"");
  pair_options.target = NULL;
  pair_options.margin = INFINITY;
  CHECK_INVALID(hs_bvh_pairs(bvh, &pair_options, &pair, 1, &total),
                "hs_bvh_pairs: options->margin: expected a finite number that "
                "is not negative, got inf");
  CHECK_INVALID(hs_bvh_pairs_each(bvh, NULL, NULL, NULL),
                "hs_bvh_pairs_each: function: expected a pointer, got null");

  CHECK_INVALID(hs_scan_masks(scan, &columns, NULL, &word, 1),
                "hs_scan_masks: words: expected at least 1 for each of 2 "
                "queries, got 1");
  CHECK_OK(hs_scan_options_default(&scan_options, sizeof(scan_options)));
  scan_options.begin = 2;
  scan_options.end = 1;
  CHECK_INVALID(hs_scan_masks(scan, &columns, &scan_options, &word, 1),
                "hs_scan_masks: options: expected a `begin` of at most `end`, "
                "got 2 and 1");
  CHECK_INVALID(hs_bvh_save(bvh, NULL),
                "hs_bvh_save: path: expected a pointer, got null");
  hs_scan_destroy(scan);
  hs_bvh_destroy(simplex);
  hs_bvh_destroy(other);
  hs_bvh_destroy(bvh);
}

void test_errors(void) {
  test_structs();
  test_columns();
  test_configurations();
  test_allocators();
  test_handles_and_outputs();
}
