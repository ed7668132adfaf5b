// Allocations that fail: the n-th, for each n, until one call needs no more.
#include <stdlib.h>

#include "check.h"

#if defined(_WIN32)
#include <malloc.h>
#define aligned_alloc(alignment, size) _aligned_malloc(size, alignment)
#define free_aligned _aligned_free
#else
#define free_aligned free
#endif

enum { OBJECTS = 3000, HALF = OBJECTS / 2, VALUES = 8 };

static float objects[OBJECTS * VALUES];
static double doubles[OBJECTS * VALUES];  // the same
static uint32_t ids[OBJECTS];

typedef struct memory {
  size_t left;   // allocations until one fails
  size_t live;   // blocks that are not freed
  size_t bytes;  // in them
  size_t most;   // so far
  int has_failed;
} memory;

static void* allocate(void* context, size_t bytes, size_t alignment) {
  memory* const its = context;
  // Rounded up, as C11's function requires.
  const size_t size = (bytes + alignment - 1) / alignment * alignment;
  void* block = NULL;
  CHECK(alignment == 64 && bytes > 0);
  if (its->left == 0) {
    its->has_failed = 1;
    return NULL;
  }
  --its->left;
  block = aligned_alloc(alignment, size);
  ++its->live;
  its->bytes += bytes;
  if (its->bytes > its->most) its->most = its->bytes;
  return block;
}
static void deallocate(void* context, void* block, size_t bytes,
                       size_t alignment) {
  memory* const its = context;
  CHECK(alignment == 64);
  --its->live;
  its->bytes -= bytes;
  free_aligned(block);
}
static hs_allocator allocator_of(memory* its) {
  hs_allocator allocator;
  allocator.allocate = allocate;
  allocator.deallocate = deallocate;
  allocator.context = its;
  return allocator;
}

// Whether the call has done what it should: otherwise there was no memory.
static int has_done(memory* its, hs_status status) {
  if (status == HS_OK) return 1;
  CHECK(status == HS_OUT_OF_MEMORY && its->has_failed);
  return 0;
}

static size_t size_of(const hs_bvh* bvh) {
  size_t size = 0;
  CHECK_OK(hs_bvh_size(bvh, &size));
  return size;
}
static size_t size_of_bodies(const hs_broad_phase* bodies) {
  size_t size = 0;
  CHECK_OK(hs_broad_phase_size(bodies, &size));
  return size;
}
static size_t pairs_of(const hs_pair_events* events) {
  const hs_id_pair* pairs = NULL;
  size_t count = 0;
  CHECK_OK(hs_pair_events_pairs(events, &pairs, &count));
  return count;
}

// A call without memory makes nothing, and changes nothing.
static void use_scans(hs_kind kind, memory* its) {
  const size_t values = hs_bound_values(kind);
  const hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  const hs_columns query = hs_float_rows(objects, 1, values);
  int bits;
  for (bits = 0; bits <= 16; bits += 8) {
    hs_scan_config config = scan_config_of(kind, bits);
    hs_scan* scan = NULL;
    size_t count = 0;
    config.allocator = allocator_of(its);
    if (has_done(its, hs_scan_create(&config, &columns, &scan))) {
      // Queries need no memory.
      const size_t left = its->left;
      CHECK_OK(hs_scan_counts(scan, &query, NULL, &count));
      CHECK(its->left == left && count > 0);
      hs_scan_destroy(scan);
    } else {
      CHECK(scan == NULL);
    }
  }
}

static void use_pair_events(hs_kind kind, memory* its) {
  const hs_columns columns =
      hs_float_rows(objects, OBJECTS, hs_bound_values(kind));
  const hs_bvh_config config = bvh_config_of(kind);
  const hs_allocator allocator = allocator_of(its);
  hs_pair_events* events = NULL;
  hs_bvh* bvh = NULL;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  if (has_done(its, hs_pair_events_create(&allocator, &events))) {
    const int done = has_done(its, hs_pair_events_update(events, bvh, NULL));
    const size_t before = pairs_of(events);
    CHECK((before > 0) == (done != 0));
    CHECK_OK(hs_bvh_erase(bvh, ids, 1));
    if (!has_done(its, hs_pair_events_update_of(events, bvh, ids, 4, NULL))) {
      CHECK(pairs_of(events) == before);
    }
    hs_pair_events_destroy(events);
  }
  hs_bvh_destroy(bvh);
}

// In memory, or in a file by runs.
static void use_builder_in(const char* path, hs_kind kind, memory* its) {
  const size_t values = hs_bound_values(kind);
  const hs_columns floats = hs_float_rows(objects, HALF, values);
  const hs_columns wide = hs_double_rows(doubles, HALF, values);
  hs_bvh_config config = bvh_config_of(kind);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  size_t pushed = 0;
  config.allocator = allocator_of(its);
  if (!has_done(its, path == NULL ? hs_builder_create(&config, &builder)
                                  : hs_builder_create_file(&config, path, 10000,
                                                           &builder))) {
    return;
  }
  pushed += (size_t)has_done(its, hs_builder_push(builder, &floats));
  pushed += (size_t)has_done(its, hs_builder_push(builder, &wide));
  if (has_done(its, hs_builder_finish(builder, &bvh))) {
    CHECK(size_of(bvh) == pushed * HALF);
    hs_bvh_destroy(bvh);
  } else {
    CHECK(bvh == NULL);
  }
  hs_builder_destroy(builder);
}
static void use_builder(hs_kind kind, memory* its) {
  use_builder_in(NULL, kind, its);
}
// One byte too few for one run, and room for all.
static void test_memory_of_a_builder_file(void) {
  const size_t values = hs_bound_values(HS_BOX3);
  const size_t whole = OBJECTS * (24 + values * sizeof(float));
  const size_t limits[] = {whole / 3, whole - 1, whole};
  const hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  size_t i;
  random_bounds(HS_BOX3, OBJECTS, 0.01f, 5, objects);
  for (i = 0; i < 3; ++i) {
    memory its = {1000, 0, 0, 0, 0};
    hs_bvh_config config = bvh_config_of(HS_BOX3);
    hs_builder* builder = NULL;
    hs_bvh* bvh = NULL;
    size_t before = 0;
    config.allocator = allocator_of(&its);
    CHECK_OK(hs_builder_create_file(&config, "c_test_memory.bvh", limits[i],
                                    &builder));
    CHECK_OK(hs_builder_push(builder, &columns));
    before = its.bytes;
    CHECK_OK(hs_builder_finish(builder, &bvh));
    CHECK(its.most <= before + limits[i]);
    hs_bvh_destroy(bvh);
    hs_builder_destroy(builder);
    CHECK(its.live == 0);
  }
  (void)remove("c_test_memory.bvh");
}

static void use_builder_file(hs_kind kind, memory* its) {
  use_builder_in("c_test_memory.bvh", kind, its);
  (void)remove("c_test_memory.bvh");
}

static void use_bvh(hs_kind kind, memory* its) {
  static uint32_t new_ids[HALF];
  const size_t values = hs_bound_values(kind);
  const hs_columns wide = hs_double_rows(doubles, HALF, values);
  const hs_columns all = hs_double_rows(doubles, OBJECTS, values);
  hs_bvh_config config = bvh_config_of(kind);
  hs_bvh* bvh = NULL;
  hs_bvh* copies[3] = {NULL, NULL, NULL};
  const void* blob = NULL;
  size_t bytes = 0;
  size_t size = HALF;
  size_t i;
  config.allocator = allocator_of(its);
  if (!has_done(its, hs_bvh_create(&config, &wide, &bvh))) return;
  if (has_done(its, hs_bvh_insert(bvh, &wide, new_ids))) size += HALF;
  CHECK(size_of(bvh) == size);
  (void)has_done(its, hs_bvh_set(bvh, ids, &wide));
  (void)has_done(its, hs_bvh_set_masks(bvh, ids, ids, HALF));
  if (has_done(its, hs_bvh_erase(bvh, ids, 100))) size -= 100;
  (void)has_done(its, hs_bvh_refit(bvh, &all, NULL, NULL));
  (void)has_done(its, hs_bvh_rebuild(bvh, NULL));
  (void)has_done(its, hs_bvh_reserve(bvh, 3 * OBJECTS));
  CHECK(size_of(bvh) == size);
  CHECK_OK(hs_bvh_blob(bvh, &blob, &bytes));
  CHECK_OK(hs_bvh_save(bvh, "c_test_memory.bvh"));
  (void)has_done(its, hs_bvh_from_blob(&config, blob, bytes, &copies[0]));
  (void)has_done(its, hs_bvh_load(&config, "c_test_memory.bvh", &copies[1]));
  (void)has_done(its, hs_bvh_map(&config, "c_test_memory.bvh", &copies[2]));
  for (i = 0; i < 3; ++i) {
    if (copies[i] == NULL) continue;
    CHECK(size_of(copies[i]) == size);
    if (has_done(its, hs_bvh_erase(copies[i], ids + 200, 1))) {
      CHECK(size_of(copies[i]) == size - 1);
    } else {
      CHECK(size_of(copies[i]) == size);
    }
    hs_bvh_destroy(copies[i]);
  }
  hs_bvh_destroy(bvh);
}

static void use_broad_phase(hs_kind kind, memory* its) {
  static char bytes[OBJECTS * 256];
  static hs_body_masks masks[100];
  const size_t values = hs_bound_values(kind);
  const hs_columns all = hs_double_rows(doubles, OBJECTS, values);
  const hs_columns moved = hs_double_rows(doubles + values, 100, values);
  const hs_columns query = hs_float_rows(objects, 1, values);
  hs_broad_phase_config config;
  hs_broad_phase* bodies = NULL;
  hs_broad_phase* copy = NULL;
  size_t expected = 0;
  size_t count = 0;
  size_t saved = 0;
  size_t left;
  int is_valid = 0;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = kind;
  config.allocator = allocator_of(its);
  if (!has_done(its, hs_broad_phase_create(&config, &bodies))) {
    CHECK(bodies == NULL);
    return;
  }
  if (has_done(its, hs_broad_phase_insert(bodies, ids, &all, NULL))) {
    expected += OBJECTS;
    (void)has_done(
        its, hs_broad_phase_pairs_of(bodies, ids, 100, NULL, NULL, 0, &count));
    (void)has_done(its, hs_broad_phase_move(bodies, ids, &moved));
    (void)has_done(its, hs_broad_phase_set_masks(bodies, ids, masks, 50));
    if (has_done(its, hs_broad_phase_erase(bodies, ids + 100, 10))) {
      expected -= 10;
    }
  }
  (void)has_done(its, hs_broad_phase_update_pairs(bodies, NULL));
  (void)has_done(its, hs_broad_phase_update(bodies, NULL));
  (void)has_done(its, hs_broad_phase_rebuild(bodies, NULL));
  if (has_done(its, hs_broad_phase_copy(bodies, &copy))) {
    if (has_done(its,
                 hs_broad_phase_save(copy, bytes, sizeof(bytes), &saved))) {
      (void)has_done(its, hs_broad_phase_load(copy, bytes, saved));
    }
    CHECK(size_of_bodies(copy) == expected);
    hs_broad_phase_destroy(copy);
  } else {
    CHECK(copy == NULL);
  }
  // The others need no memory.
  left = its->left;
  CHECK_OK(hs_broad_phase_count(bodies, &query, NULL, &count));
  CHECK((count > 0) == (expected > 0) && its->left == left);
  CHECK(size_of_bodies(bodies) == expected);
  CHECK_OK(hs_broad_phase_validate(bodies, &is_valid));
  CHECK(is_valid);
  hs_broad_phase_destroy(bodies);
}

// A wrong allocator is no wrong file.
static void* allocate_misaligned(void* context, size_t bytes,
                                 size_t alignment) {
  char* const block = allocate(context, bytes + alignment, alignment);
  return block == NULL || ((memory*)context)->left > 0 ? block : block + 4;
}
static void deallocate_misaligned(void* context, void* block, size_t bytes,
                                  size_t alignment) {
  deallocate(context, (char*)block - (uintptr_t)block % alignment,
             bytes + alignment, alignment);
}
static void test_misaligned(void) {
  hs_bvh_config config = bvh_config_of(HS_BOX3);
  const hs_columns columns = hs_float_rows(objects, 10, 6);
  const void* blob = NULL;
  size_t size = 0;
  hs_bvh* bvh = NULL;
  hs_bvh* copy = NULL;
  memory its = {0, 0, 0, 0, 0};
  size_t left;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_OK(hs_bvh_blob(bvh, &blob, &size));
  config.allocator = allocator_of(&its);
  config.allocator.allocate = allocate_misaligned;
  config.allocator.deallocate = deallocate_misaligned;
  // The first allocation, and one while the bytes are loaded.
  for (left = 1; left <= 2; ++left) {
    its.left = left;
    CHECK_INVALID(hs_bvh_from_blob(&config, blob, size, &copy),
                  "hs_bvh_from_blob: allocator.allocate: expected "
                  "memory aligned to 64 bytes, got a misaligned block");
    CHECK(copy == NULL && its.live == 0 && its.bytes == 0);
  }
  hs_bvh_destroy(bvh);
}

// The n-th allocation fails, for each n.
static void use_without_memory(void (*use)(hs_kind kind, memory* its),
                               hs_kind kind, size_t least) {
  memory its = {0, 0, 0, 0, 1};
  size_t n;
  for (n = 0; its.has_failed; ++n) {
    its.has_failed = 0;
    its.left = n;
    use(kind, &its);
    CHECK(its.live == 0 && its.bytes == 0);
  }
  CHECK(n > least);
}

void test_memory(void) {
  const hs_kind kinds[] = {HS_BOX2, HS_SIMPLEX3};
  size_t i;
  size_t k;
  for (i = 0; i < OBJECTS; ++i) ids[i] = (uint32_t)i;
  for (k = 0; k < 2; ++k) {
    random_bounds(kinds[k], OBJECTS, 0.1f, 13, objects);
    for (i = 0; i < OBJECTS * VALUES; ++i) doubles[i] = (double)objects[i];
    use_without_memory(use_builder, kinds[k], 3);
    use_without_memory(use_builder_file, kinds[k], 3);
    use_without_memory(use_bvh, kinds[k], 8);
    use_without_memory(use_scans, kinds[k], 2);
    if (is_simplex(kinds[k])) continue;
    use_without_memory(use_broad_phase, kinds[k], 10);
    use_without_memory(use_pair_events, kinds[k], 5);
  }
  (void)remove("c_test_memory.bvh");
  test_misaligned();
  test_memory_of_a_builder_file();
}
