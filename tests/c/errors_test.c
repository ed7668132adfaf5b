// What a call says of an argument that is wrong, and that it changes nothing.
#include <math.h>

#include "check.h"

static const float kBoxes[] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};

// Programs that were compiled with an older header pass these structs.
#if UINTPTR_MAX == UINT64_MAX
#define OFFSETS1(type, field, offset) \
  _Static_assert(offsetof(type, field) == (offset), #type)
#define OFFSETS2(type, field, offset, ...) \
  OFFSETS1(type, field, offset);           \
  OFFSETS1(type, __VA_ARGS__)
#define OFFSETS3(type, field, offset, ...) \
  OFFSETS1(type, field, offset);           \
  OFFSETS2(type, __VA_ARGS__)
#define OFFSETS4(type, field, offset, ...) \
  OFFSETS1(type, field, offset);           \
  OFFSETS3(type, __VA_ARGS__)
#define OFFSETS5(type, field, offset, ...) \
  OFFSETS1(type, field, offset);           \
  OFFSETS4(type, __VA_ARGS__)
#define OFFSETS6(type, field, offset, ...) \
  OFFSETS1(type, field, offset);           \
  OFFSETS5(type, __VA_ARGS__)
#define OFFSETS7(type, field, offset, ...) \
  OFFSETS1(type, field, offset);           \
  OFFSETS6(type, __VA_ARGS__)
OFFSETS3(hs_allocator, allocate, 0, deallocate, 8, context, 16);
OFFSETS4(hs_columns, type, 0, count, 8, stride, 16, column, 24);
_Static_assert(sizeof(hs_columns) == 96, "hs_columns");
OFFSETS2(hs_bound_options, empty_if_inverted, 8, target, 16);
OFFSETS3(hs_scan_config, kind, 8, bits, 12, allocator, 16);
OFFSETS4(hs_scan_options, begin, 8, end, 16, skip, 24, target, 32);
OFFSETS6(hs_bvh_config, kind, 8, quality, 12, target, 16, run, 24, run_context,
         32, allocator, 40);
OFFSETS5(hs_query_options, mask, 8, shape, 12, skip, 16, target, 24, exclusive,
         32);
OFFSETS1(hs_id_pair, b, 4);
OFFSETS7(hs_pair_options, mask, 8, margin, 12, skip, 16, begin, 24, end, 32,
         target, 40, wanted, 48);
OFFSETS1(hs_pair_options, within, 56);
OFFSETS5(hs_pair_event_options, mask, 8, margin, 12, target, 16, run, 24,
         run_context, 32);
OFFSETS1(hs_body_masks, collides_with, 4);
OFFSETS6(hs_broad_phase_config, kind, 8, moves_are_seen_at_once, 12,
         caller_locks, 16, keep, 24, keep_context, 32, allocator, 40);
OFFSETS3(hs_update_options, budget, 8, run, 16, run_context, 24);
OFFSETS4(hs_body_statistics, bodies, 8, pairs, 16, bytes, 24, cost_ratio, 32);
#endif

static void test_structs(void) {
  struct {
    hs_query_options known;
    unsigned char unknown[8];
  } newer;
  hs_query_options options;
  const hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_bvh* const bvh = bvh_of(HS_BOX3, &columns);
  size_t total = 0;
  uint32_t ids[2];

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
  INVALID(hs_bvh_query, (bvh, &columns, &options, ids, 2, NULL, &total),
          "options->struct_size: expected sizeof *options, as the function "
          "..._default() sets it, got 0");
  options.struct_size = sizeof(options) - 1;
  INVALID(hs_bvh_query, (bvh, &columns, &options, ids, 2, NULL, &total),
          "options->struct_size: expected a multiple of 4, as the function "
          "..._default() sets it, got 39");
  NOT_NULL(hs_bvh_config_default, (NULL, sizeof(hs_bvh_config)), "the struct");
  INVALID(hs_bvh_config_default,
          ((hs_bvh_config*)(void*)((char*)&newer + 1), sizeof(newer)),
          "the struct: expected memory aligned to 8 bytes, got a misaligned "
          "pointer");
  INVALID(
      hs_bvh_query,
      (bvh, &columns, (hs_query_options*)(void*)((char*)&newer + 4), ids, 2,
       NULL, &total),
      "options: expected memory aligned to 8 bytes, got a misaligned pointer");
  INVALID(hs_pair_options_default, ((hs_pair_options*)(void*)&newer, 0),
          "struct_size: expected the sizeof of the struct, got 0");
  hs_bvh_destroy(bvh);
}

static void test_columns(void) {
  const size_t end = 2;
  float bounds[8];
  const hs_bvh_config config = bvh_config_of(HS_BOX3);
  hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  size_t size = 0;
  NOT_NULL(hs_bvh_create, (&config, NULL, &bvh), "objects");
  columns.column[4] = NULL;
  NOT_NULL(hs_bvh_create, (&config, &columns, &bvh), "objects->column[4]");
  columns.column[4] = (const char*)kBoxes + 1;
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "objects->column[4]: expected memory aligned to 4 bytes, got a "
          "misaligned pointer");
  columns = hs_float_rows(kBoxes, 2, 6);
  columns.type = (hs_scalar)2;
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "objects->type: expected an enumerator of hs_scalar, got 2");
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
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "objects: expected fewer than 2^31 objects in all, got 2147483648");
  CHECK(bvh == NULL);
  // No copy is made first.
  CHECK_OK(hs_builder_create(&config, &builder));
  INVALID(hs_builder_push, (builder, &columns),
          "objects: expected fewer than 2^31 objects in all, got 2147483648");
  hs_builder_destroy(builder);
  // Of point sets, coordinates that are apart and have a stride.
  columns = hs_float_rows(kBoxes, 2, 3);
  columns.column[1] = kBoxes + 2;
  CHECK_FAILS(
      hs_bound_point_sets(HS_BOX2, &columns, &end, 1, NULL, bounds, NULL),
      HS_UNSUPPORTED,
      "hs_bound_point_sets: points: expected adjacent coordinates or a stride "
      "of 1, got columns apart with a stride of 3: copy the points");
  // Each for itself they are bounded.
  CHECK_OK(hs_bound_points(HS_BOX2, &columns, NULL, bounds, NULL));
  // The stride of one record is not used.
  columns = hs_float_rows(kBoxes, 1, 6);
  columns.stride = SIZE_MAX;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  hs_bvh_destroy(bvh);
}

static void* no_memory(void* context, size_t bytes, size_t alignment) {
  (void)context;
  (void)bytes;
  (void)alignment;
  return NULL;
}

static void test_configurations(void) {
  const hs_columns columns = hs_float_rows(kBoxes, 2, 6);
  hs_bvh_config config = bvh_config_of((hs_kind)0);
  hs_scan_config scan_config = scan_config_of(HS_BOX3, 9);
  hs_bvh* bvh = NULL;
  hs_builder* builder = NULL;
  hs_scan* scan = NULL;
  hs_pair_events* events = NULL;
  float bounds[8];
  const float wrong_extents[3] = {0, -1, 0};
  CHECK(hs_bound_values((hs_kind)7) == 0);
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "config->kind: expected an enumerator of hs_kind, got 0");
  INVALID(hs_bound_boxes, ((hs_kind)-1, &columns, NULL, bounds, NULL),
          "kind: expected an enumerator of hs_kind, got -1");
  NOT_NULL(hs_bvh_create, (NULL, &columns, &bvh), "config");
  config.kind = HS_BOX3;
  config.quality = (hs_quality)2;
  INVALID(hs_builder_create, (&config, &builder),
          "config->quality: expected an enumerator of hs_quality, got 2");
  config.quality = HS_QUALITY_HIGH;
  config.query_extents = wrong_extents;
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "config->query_extents: expected numbers that are not negative, got "
          "-1 on axis 1");
  config.query_extents = NULL;
  config.target = "avx9";
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "config->target: expected null or a name of hs_target_name(), got "
          "\"avx9\"");
  config.target = NULL;
  // A context alone is no allocator.
  config.allocator.context = &config;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  hs_bvh_destroy(bvh);
  bvh = NULL;
  config.allocator.allocate = no_memory;
  INVALID(hs_bvh_create, (&config, &columns, &bvh),
          "config->allocator: expected both functions or neither, got allocate "
          "alone");
  INVALID(hs_pair_events_create, (&config.allocator, &events),
          "allocator: expected both functions or neither, got allocate alone");
  config.allocator.allocate = NULL;
  INVALID(hs_scan_create, (&scan_config, &columns, &scan),
          "config->bits: expected 0, 8 or 16, got 9");
  NOT_NULL(hs_bvh_create, (&config, &columns, NULL), "bvh");
  CHECK(bvh == NULL && scan == NULL && builder == NULL && events == NULL);
}

static hs_visit no_ids(void* context, size_t query, const uint32_t* ids,
                       size_t count) {
  (void)context;
  (void)query;
  (void)ids;
  (void)count;
  return HS_CONTINUE;
}

static float no_hit(void* context, size_t cast, uint32_t id, float t) {
  (void)context;
  (void)cast;
  (void)id;
  return t;
}

#define BAD_TARGET(function, arguments)                                        \
  INVALID(function, arguments,                                                 \
          "options->target: expected null or a name of hs_target_name(), got " \
          "\"x\"")
#define NO_BODY(function, arguments) \
  INVALID(function, arguments, "ids[1]: expected the id of a body, got 900")

static void test_handles_and_outputs(void) {
  const hs_id_pair swapped = {2, 1};
  hs_pair_event_options event_options;
  hs_pair_events* events = NULL;
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
  hs_bvh* const bvh = bvh_of(HS_BOX3, &columns);
  hs_bvh* const other = bvh_of(HS_BOX2, &columns);
  hs_bvh* const simplex = bvh_of(HS_SIMPLEX2, &columns);
  hs_scan* scan = NULL;
  size_t total = 0;
  uint32_t ids[4] = {0, 7, 0, 0};
  const uint32_t masks[] = {1, 2};
  uint64_t word = 0;
  hs_id_pair pair;
  CHECK_OK(hs_scan_create(&scan_config, &columns, &scan));

  NOT_NULL(hs_bvh_query, (NULL, &columns, NULL, ids, 4, NULL, &total), "bvh");
  NOT_NULL(hs_bvh_query, (bvh, &columns, NULL, NULL, 4, NULL, &total), "ids");
  NOT_NULL(hs_bvh_query, (bvh, &columns, NULL, ids, 4, NULL, NULL), "total");
  INVALID(hs_bvh_query, (bvh, &columns, NULL, ids, SIZE_MAX, NULL, &total),
          "ids: expected a size that fits the address space, got "
          "18446744073709551615 elements");
  NOT_NULL(hs_bvh_query_each, (bvh, &columns, NULL, NULL, NULL), "function");
  INVALID(hs_bvh_reserve, (bvh, (size_t)1 << 31),
          "objects: expected fewer than 2^31 objects in all, got 2147483648");
  INVALID(hs_bvh_erase, (bvh, ids, 2),
          "ids[1]: expected the id of an object, got 7");
  CHECK_OK(hs_bvh_size(bvh, &total));
  CHECK(total == 2);
  NOT_NULL(hs_bvh_insert_as, (bvh, NULL, &columns), "ids");
  CHECK_OK(hs_bvh_set_masks(bvh, NULL, NULL, 0));
  NOT_NULL(hs_bvh_set_masks, (bvh, NULL, masks, 1), "ids");
  INVALID(hs_bvh_set_all_masks, (bvh, masks, 1),
          "masks: expected a mask for each id, at least 2, got 1");
  INVALID(hs_bvh_refit, (bvh, &one, NULL, NULL),
          "objects: expected a bound for each id, at least 2, got 1");
  INVALID(hs_bvh_get_all, (bvh, bounds, 1),
          "room: expected at least hs_bvh_id_limit(), 2, got 1");
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  options.exclusive = 1;
  INVALID(hs_bvh_nearest_to_boxes,
          (simplex, &columns, 1, 1, &options, ids, NULL),
          "options->exclusive: expected 0, as the bounds are not boxes, got 1");
  INVALID(hs_bvh_nearest_to_points, (bvh, &columns, 1, NAN, NULL, ids, NULL),
          "max_distance: expected a number that is not negative, got nan");
  INVALID(hs_bvh_nearest_to_boxes,
          (bvh, &columns, SIZE_MAX, 1, NULL, ids, NULL),
          "k: expected rows that fit the address space, got "
          "18446744073709551615 for each of 2 queries");
  INVALID(hs_bvh_nearest_to_boxes,
          (bvh, &inverted_boxes, 1, 1, NULL, ids, NULL),
          "boxes: expected minima that are not above the maxima, got 2 and 1 "
          "on axis 1 of box 1");
  INVALID(
      hs_bound_boxes,
      (HS_BOX3, &columns, NULL, bounds, (size_t*)(void*)((char*)&total + 1)),
      "everything: expected memory aligned to 8 bytes, got a misaligned "
      "pointer");
  INVALID(hs_bvh_raycast, (bvh, &rays, 0, NULL, ids, NULL),
          "rays->column[6]: expected limits of t that are not negative, got "
          "-1.0000001 of ray 0");
  ray[6] = 1;
  INVALID(hs_bvh_raycast, (bvh, &rays, -1, NULL, ids, NULL),
          "radius: expected a number that is not negative, got -1");
  rays = hs_double_rows(double_ray, 1, 7);
  INVALID(hs_bvh_raycast, (bvh, &rays, 0, NULL, ids, NULL),
          "rays->type: expected HS_FLOAT32, as these cannot be rounded "
          "outward, got HS_FLOAT64");
  NOT_NULL(hs_bvh_raycast_each, (bvh, &rays, 0, NULL, NULL, NULL), "function");

  INVALID(hs_bvh_join, (bvh, other, NULL, &pair, 1, &total),
          "b: expected a BVH of the kind of `a`, got another kind");
  CHECK_OK(hs_pair_events_create(NULL, &events));
  NOT_NULL(hs_pair_events_update, (events, NULL, NULL), "bvh");
  NOT_NULL(hs_pair_events_update_of, (events, bvh, NULL, 1, NULL), "changed");
  CHECK_OK(hs_pair_event_options_default(&event_options, sizeof event_options));
  event_options.margin = -1;
  INVALID(
      hs_pair_events_update, (events, bvh, &event_options),
      "options->margin: expected a finite number that is not negative, got -1");
  INVALID(hs_pair_events_load, (events, &swapped, 1),
          "pairs[0]: expected a < b < 4294967295, got 2 and 1");
  NOT_NULL(hs_pair_events_began, (events, NULL, &total), "pairs");
  hs_pair_events_destroy(events);
  INVALID(hs_bvh_pairs, (simplex, NULL, &pair, 1, &total),
          "expected BVHs of boxes or octahedra, got simplices, which have no "
          "planes that face each other");
  CHECK_OK(hs_pair_options_default(&pair_options, sizeof(pair_options)));
  CHECK_OK(hs_query_options_default(&options, sizeof(options)));
  CHECK_OK(hs_bound_options_default(&bound_options, sizeof(bound_options)));
  CHECK_OK(hs_scan_options_default(&scan_options, sizeof(scan_options)));
  options.target = pair_options.target = "x";
  bound_options.target = scan_options.target = "x";
  BAD_TARGET(hs_bvh_count, (bvh, &columns, &options, &total));
  BAD_TARGET(hs_bvh_pairs, (bvh, &pair_options, &pair, 1, &total));
  BAD_TARGET(hs_bound_boxes, (HS_BOX3, &columns, &bound_options, bounds, NULL));
  BAD_TARGET(hs_scan_counts, (scan, &columns, &scan_options, &total));
  NOT_NULL(hs_bvh_pairs_each, (bvh, NULL, NULL, NULL), "function");

  INVALID(hs_scan_masks, (scan, &columns, NULL, &word, 1),
          "words: expected at least 1 for each of 2 queries, got 1");
  CHECK_OK(hs_scan_options_default(&scan_options, sizeof(scan_options)));
  scan_options.begin = 2;
  scan_options.end = 1;
  INVALID(hs_scan_masks, (scan, &columns, &scan_options, &word, 1),
          "options: expected a `begin` of at most `end`, got 2 and 1");
  NOT_NULL(hs_bvh_save, (bvh, NULL), "path");
  hs_scan_destroy(scan);
  hs_bvh_destroy(simplex);
  hs_bvh_destroy(other);
  hs_bvh_destroy(bvh);
}

static void test_bodies(void) {
  const float boxes[] = {0, 0, 1, 1, 2, 2, 3, 3};
  const double doubles[] = {0, 0, 1, 2};
  const float motion[] = {1, 0, -1};
  const uint32_t ids[] = {5, 900};
  const uint32_t large[] = {5, (uint32_t)1 << 31};
  const hs_body_masks masks[] = {{1, 1}, {1, 1}};
  hs_columns columns = hs_float_rows(boxes, 2, 4);
  hs_columns one = hs_float_rows(boxes, 1, 4);
  hs_columns motions = hs_float_rows(motion, 1, 3);
  hs_broad_phase_config config;
  hs_query_options query;
  hs_body_statistics statistics;
  static char bytes[4096];
  static float many[65 * 3];
  float record[4];
  uint32_t id = 0;
  size_t size = 0;
  hs_broad_phase* bodies = NULL;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  CHECK_OK(hs_query_options_default(&query, sizeof(query)));
  config.kind = HS_SIMPLEX2;
  query.shape = HS_SHAPE_SPHERE;
  INVALID(hs_broad_phase_create, (&config, &bodies),
          "config->kind: expected boxes or octahedra, got simplices, which "
          "have no planes that face each other");
  config.kind = HS_BOX2;
  CHECK(bodies == NULL);
  CHECK_OK(hs_broad_phase_create(&config, &bodies));
  NOT_NULL(hs_broad_phase_insert, (bodies, NULL, &columns, NULL), "ids");
  INVALID(hs_broad_phase_insert, (bodies, large, &columns, NULL),
          "ids[1]: expected an id below 2^31, got 2147483648");
  CHECK_OK(hs_broad_phase_insert(bodies, ids, &one, NULL));
  NO_BODY(hs_broad_phase_move, (bodies, ids, &columns));
  NO_BODY(hs_broad_phase_set_masks, (bodies, ids, masks, 2));
  NOT_NULL(hs_broad_phase_set_masks, (bodies, ids, NULL, 1), "masks");
  NO_BODY(hs_broad_phase_get, (bodies, ids, 2, NULL, NULL));
  one = hs_double_rows(doubles, 1, 3);
  INVALID(hs_broad_phase_query_each, (bodies, &one, &query, no_ids, NULL),
          "queries->type: expected HS_FLOAT32, as these cannot be rounded "
          "outward, got HS_FLOAT64");
  INVALID(hs_broad_phase_count, (bodies, &motions, &query, &size),
          "radius: expected a number that is not negative, got -1");
  query.shape = (hs_shape)5;
  INVALID(hs_broad_phase_any, (bodies, &motions, &query, &id),
          "options->shape: expected an enumerator of hs_shape, got 5");
  query.shape = HS_SHAPE_HALF_SPACES;
  one = hs_float_rows(many, 65, 3);
  INVALID(hs_broad_phase_any, (bodies, &one, &query, &id),
          "queries->count: expected at most 64 half-spaces, got 65");
  NOT_NULL(hs_frustum_planes, (NULL, HS_CLIP_ZERO_TO_ONE, HS_ROW_MAJOR, many),
           "matrix");
  NOT_NULL(hs_frustum_planes, (many, HS_CLIP_ZERO_TO_ONE, HS_ROW_MAJOR, NULL),
           "half_spaces");
  INVALID(hs_frustum_planes, (many, (hs_clip_depth)2, HS_ROW_MAJOR, many),
          "depth: expected an enumerator of hs_clip_depth, got 2");
  INVALID(hs_frustum_planes,
          (many, HS_CLIP_ZERO_TO_ONE, (hs_matrix_order)2, many),
          "order: expected an enumerator of hs_matrix_order, got 2");
  query.shape = HS_SHAPE_BOUND;
  one = hs_float_rows(boxes, 1, 4);
  INVALID(hs_broad_phase_spherecast, (bodies, &motions, &one, NULL, &id, NULL),
          "spheres->column[2]: expected radii that are not negative, got -1 of "
          "sphere 0");
  INVALID(hs_broad_phase_boxcast, (bodies, &one, &motions, NULL, &id, NULL),
          "motions->column[2]: expected limits of t that are not negative, got "
          "-1 of motion 0");
  INVALID(hs_broad_phase_boxcast_each,
          (bodies, &columns, &motions, NULL, no_hit, NULL),
          "motions->count: expected one for each of 2 boxes, got 1");
  NOT_NULL(hs_broad_phase_boxcast, (bodies, &one, &motions, NULL, NULL, NULL),
           "ids");
  motions = hs_double_rows(doubles, 1, 3);
  INVALID(hs_broad_phase_boxcast_each,
          (bodies, &one, &motions, NULL, no_hit, NULL),
          "motions->type: expected HS_FLOAT32, as these cannot be rounded "
          "outward, got HS_FLOAT64");
  INVALID(hs_broad_phase_statistics, (bodies, &statistics, 3),
          "struct_size: expected the sizeof of the struct, got 3");
  NOT_NULL(hs_broad_phase_validate, (NULL, NULL), "bodies");
  // Wrong bytes change nothing.
  CHECK_OK(hs_broad_phase_save(bodies, bytes, sizeof(bytes), &size));
  CHECK(size > 64 && size <= sizeof(bytes));
  CHECK_FAILS(hs_broad_phase_load(bodies, bytes, 20), HS_CORRUPT,
              "hs_broad_phase_load: data: expected all bytes of "
              "BroadPhase::Save(), got 20 bytes");
  CHECK(hs_broad_phase_load(bodies, bytes, size - 64) == HS_CORRUPT);
  NOT_NULL(hs_broad_phase_load, (bodies, NULL, size), "data");
  bytes[9] ^= 1;
  CHECK(hs_broad_phase_load(bodies, bytes, size) == HS_CORRUPT);
  CHECK_OK(hs_broad_phase_get(bodies, ids, 1, record, NULL));
  CHECK(memcmp(record, boxes, sizeof(record)) == 0);
  hs_broad_phase_destroy(bodies);
}

static void test_meshes(void) {
  const float numbers[18] = {0};
  const uint32_t indices[3] = {0, 1, 2};
  const hs_columns vertices = hs_float_rows(numbers, 2, 3);
  const hs_columns rays = hs_float_rows(numbers, 1, 7);
  const float backward[7] = {0, 0, 0, 0, 0, 0, -1};
  const hs_columns bad_rays = hs_float_rows(backward, 1, 7);
  const hs_columns corners = hs_float_rows(numbers, 6, 3);
  hs_columns doubles = corners;
  hs_mesh* mesh = NULL;
  uint32_t id = 0;
  uint8_t is_hit = 0;
  doubles.type = HS_FLOAT64;
  INVALID(hs_mesh_create, (&vertices, NULL, 1, NULL, &mesh),
          "faces: expected at most a third of the 2 vertices, got 1");
  CHECK(hs_mesh_create(&vertices, indices, 1, NULL, &mesh) ==
        HS_INVALID_ARGUMENT);
  CHECK(hs_mesh_create(&doubles, NULL, 2, NULL, &mesh) == HS_INVALID_ARGUMENT);
  NOT_NULL(hs_mesh_create, (&corners, NULL, 2, NULL, NULL), "mesh");
  CHECK_OK(hs_mesh_create(&corners, NULL, 2, NULL, &mesh));
  INVALID(hs_mesh_closest_points,
          (mesh, &corners, -1.0f, NULL, &id, NULL, NULL),
          "max_distance: expected a number that is not negative, got -1");
  INVALID(hs_mesh_raycast, (mesh, &bad_rays, NULL, &id, NULL),
          "rays->column[6]: expected limits of t that are not negative, got -1 "
          "of ray 0");
  INVALID(hs_mesh_occluded, (mesh, &rays, "none", &is_hit),
          "target: expected null or a name of hs_target_name(), got \"none\"");
  NOT_NULL(hs_mesh_raycast, (NULL, &rays, NULL, &id, NULL), "mesh");
  NOT_NULL(hs_mesh_occluded, (mesh, NULL, NULL, &is_hit), "rays");
  NOT_NULL(hs_mesh_raycast_each, (mesh, &rays, NULL, NULL, NULL), "function");
  hs_mesh_destroy(mesh);
  hs_mesh_destroy(NULL);
}

void test_errors(void) {
  test_structs();
  test_columns();
  test_configurations();
  test_handles_and_outputs();
  test_bodies();
  test_meshes();
}
