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

enum { OBJECTS = 3000, VALUES = 8 };

static float objects[OBJECTS * VALUES];

typedef struct memory {
  size_t left;   // allocations until one fails
  size_t live;   // blocks that are not freed
  size_t bytes;  // in them
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

static void use_scan(hs_kind kind, int bits, memory* its) {
  hs_scan_config config = scan_config_of(kind, bits);
  const hs_columns columns =
      hs_float_rows(objects, OBJECTS, hs_bound_values(kind));
  hs_scan* scan = NULL;
  size_t count = 0;
  config.allocator = allocator_of(its);
  if (!has_done(its, hs_scan_create(&config, &columns, &scan))) {
    CHECK(scan == NULL);
    return;
  }
  // Queries need no memory.
  {
    const hs_columns query = hs_float_rows(objects, 1, hs_bound_values(kind));
    const size_t left = its->left;
    CHECK_OK(hs_scan_counts(scan, &query, NULL, &count));
    CHECK(its->left == left && count > 0);
  }
  hs_scan_destroy(scan);
}

static size_t size_of(const hs_bvh* bvh) {
  size_t size = 0;
  CHECK_OK(hs_bvh_size(bvh, &size));
  return size;
}

// An update without memory changes nothing.
static void use_pair_events(hs_kind kind, int bits, memory* its) {
  const hs_columns columns =
      hs_float_rows(objects, OBJECTS, hs_bound_values(kind));
  const hs_bvh_config config = bvh_config_of(kind);
  const hs_allocator allocator = allocator_of(its);
  static const uint32_t changed[] = {2, 5, 8, OBJECTS};
  const hs_id_pair* pairs = NULL;
  hs_pair_events* events = NULL;
  hs_bvh* bvh = NULL;
  size_t count = 0;
  size_t before = 0;
  (void)bits;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  if (has_done(its, hs_pair_events_create(&allocator, &events))) {
    const int done = has_done(its, hs_pair_events_update(events, bvh, NULL));
    CHECK_OK(hs_pair_events_pairs(events, &pairs, &before));
    CHECK((before > 0) == (done != 0));
    CHECK_OK(hs_bvh_erase(bvh, changed, 1));
    if (!has_done(its,
                  hs_pair_events_update_of(events, bvh, changed, 4, NULL))) {
      CHECK_OK(hs_pair_events_pairs(events, &pairs, &count));
      CHECK(count == before);
    }
    CHECK_OK(hs_pair_events_load(events, NULL, 0));
    CHECK_OK(hs_pair_events_pairs(events, &pairs, &count));
    CHECK(count == 0);
    hs_pair_events_destroy(events);
  }
  hs_bvh_destroy(bvh);
}

static void use_bvh(hs_kind kind, int bits, memory* its) {
  static uint32_t ids[OBJECTS];
  static double doubles[OBJECTS * VALUES];
  const size_t values = hs_bound_values(kind);
  hs_bvh_config config = bvh_config_of(kind);
  hs_columns columns = hs_float_rows(objects, OBJECTS / 2, values);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  const void* blob = NULL;
  size_t size = 0;
  size_t i;
  for (i = 0; i < OBJECTS * values; ++i) doubles[i] = (double)objects[i];
  (void)bits;
  config.allocator = allocator_of(its);
  if (has_done(its, hs_builder_create(&config, &builder))) {
    // A batch that does not fit changes nothing.
    size_t pushed = 0;
    pushed += (size_t)has_done(its, hs_builder_push(builder, &columns));
    columns = hs_double_rows(doubles, OBJECTS / 2, values);
    pushed += (size_t)has_done(its, hs_builder_push(builder, &columns));
    if (has_done(its, hs_builder_finish(builder, &bvh))) {
      CHECK(size_of(bvh) == pushed * (OBJECTS / 2));
      hs_bvh_destroy(bvh);
      bvh = NULL;
    }
    CHECK(bvh == NULL);
    hs_builder_destroy(builder);
  }
  if (!has_done(its, hs_bvh_create(&config, &columns, &bvh))) return;
  size = size_of(bvh);
  if (has_done(its, hs_bvh_insert(bvh, &columns, ids))) {
    size += OBJECTS / 2;
  }
  CHECK(size_of(bvh) == size);
  for (i = 0; i < OBJECTS / 2; ++i) ids[i] = (uint32_t)i;
  (void)has_done(its, hs_bvh_set(bvh, ids, &columns));
  (void)has_done(its, hs_bvh_set_masks(bvh, ids, ids, OBJECTS / 2));
  if (has_done(its, hs_bvh_erase(bvh, ids, 100))) size -= 100;
  CHECK(size_of(bvh) == size);
  columns = hs_double_rows(doubles, OBJECTS, values);
  (void)has_done(its, hs_bvh_refit(bvh, &columns, NULL, NULL));
  (void)has_done(its, hs_bvh_rebuild(bvh, NULL));
  (void)has_done(its, hs_bvh_reserve(bvh, 3 * OBJECTS));
  CHECK(size_of(bvh) == size);
  {
    hs_bvh* copy = NULL;
    size_t bytes = 0;
    CHECK_OK(hs_bvh_blob(bvh, &blob, &bytes));
    if (has_done(its, hs_bvh_from_blob(&config, blob, bytes, &copy))) {
      CHECK(size_of(copy) == size);
      hs_bvh_destroy(copy);
    }
    CHECK_OK(hs_bvh_save(bvh, "c_test_memory.bvh"));
    copy = NULL;
    if (has_done(its, hs_bvh_load(&config, "c_test_memory.bvh", &copy))) {
      CHECK(size_of(copy) == size);
      hs_bvh_destroy(copy);
    }
    copy = NULL;
    if (has_done(its, hs_bvh_map(&config, "c_test_memory.bvh", &copy))) {
      if (has_done(its, hs_bvh_erase(copy, ids + 200, 1))) --size;
      CHECK(size_of(copy) == size);
      hs_bvh_destroy(copy);
    }
  }
  hs_bvh_destroy(bvh);
}

// A call without memory changes nothing.
static void use_broad_phase(hs_kind kind, int bits, memory* its) {
  static uint32_t ids[OBJECTS];
  static double doubles[OBJECTS * VALUES];
  static char bytes[OBJECTS * 256];
  static hs_body_masks masks[OBJECTS];
  const size_t values = hs_bound_values(kind);
  hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  hs_broad_phase_config config;
  hs_broad_phase* bodies = NULL;
  hs_broad_phase* copy = NULL;
  hs_body_statistics statistics;
  const hs_id_pair* pairs = NULL;
  size_t listed = 0;
  size_t size = 0;
  size_t saved = 0;
  size_t expected = 0;
  size_t count = 0;
  size_t i;
  int is_valid = 0;
  (void)bits;
  for (i = 0; i < OBJECTS; ++i) ids[i] = (uint32_t)i;
  for (i = 0; i < OBJECTS * values; ++i) doubles[i] = (double)objects[i];
  for (i = 0; i < OBJECTS; ++i) masks[i].category = masks[i].collides_with = 3;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = kind;
  config.allocator = allocator_of(its);
  if (!has_done(its, hs_broad_phase_create(&config, &bodies))) {
    CHECK(bodies == NULL);
    return;
  }
  columns.count = OBJECTS - 100;
  if (has_done(its, hs_broad_phase_insert(bodies, ids, &columns, NULL))) {
    expected += columns.count;
  }
  columns = hs_double_rows(doubles, 100, values);
  if (has_done(its, hs_broad_phase_insert(bodies, ids + OBJECTS - 100, &columns,
                                          masks))) {
    expected += 100;
    (void)has_done(its,
                   hs_broad_phase_move(bodies, ids + OBJECTS - 100, &columns));
    (void)has_done(
        its, hs_broad_phase_set_masks(bodies, ids + OBJECTS - 50, masks, 50));
    if (has_done(its, hs_broad_phase_erase(bodies, ids + OBJECTS - 100, 10))) {
      expected -= 10;
    }
  }
  (void)has_done(its, hs_broad_phase_update_pairs(bodies, NULL));
  (void)has_done(its, hs_broad_phase_update(bodies, NULL));
  (void)has_done(its, hs_broad_phase_rebuild(bodies, NULL));
  CHECK_OK(hs_broad_phase_pairs(bodies, &pairs, &listed));
  if (expected > 1000) {
    (void)has_done(
        its, hs_broad_phase_pairs_of(bodies, ids, 100, NULL, NULL, 0, &count));
  }
  if (has_done(its, hs_broad_phase_copy(bodies, &copy))) {
    CHECK_OK(hs_broad_phase_size(copy, &size));
    CHECK(size == expected);
    if (has_done(its,
                 hs_broad_phase_save(copy, bytes, sizeof(bytes), &saved))) {
      CHECK(saved <= sizeof(bytes));
      (void)has_done(its, hs_broad_phase_load(copy, bytes, saved));
      CHECK_OK(hs_broad_phase_size(copy, &size));
      CHECK(size == expected);
    }
    hs_broad_phase_destroy(copy);
  } else {
    CHECK(copy == NULL);
  }
  // The others need no memory.
  {
    const size_t left = its->left;
    columns = hs_float_rows(objects, 1, values);
    CHECK_OK(hs_broad_phase_count(bodies, &columns, NULL, &count));
    CHECK((count > 0) == (expected > 1000));
    CHECK_OK(hs_broad_phase_size(bodies, &size));
    CHECK(size == expected);
    CHECK_OK(hs_broad_phase_validate(bodies, &is_valid));
    CHECK(is_valid);
    CHECK_OK(
        hs_broad_phase_statistics(bodies, &statistics, sizeof(statistics)));
    CHECK(statistics.pairs == listed && its->left == left);
  }
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
  memory its = {0, 0, 0, 0};
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
static void use_without_memory(void (*use)(hs_kind kind, int bits, memory* its),
                               hs_kind kind, int bits, size_t least) {
  memory its = {0, 0, 0, 1};
  size_t n;
  for (n = 0; its.has_failed; ++n) {
    its.has_failed = 0;
    its.left = n;
    use(kind, bits, &its);
    CHECK(its.live == 0 && its.bytes == 0);
  }
  CHECK(n > least);
}

void test_memory(void) {
  const hs_kind kinds[] = {HS_BOX2, HS_SIMPLEX3};
  size_t i;
  int bits;
  for (i = 0; i < 2; ++i) {
    random_bounds(kinds[i], OBJECTS, 0.1f, 13, objects);
    use_without_memory(use_bvh, kinds[i], 0, 10);
    if (!is_simplex(kinds[i])) {
      use_without_memory(use_broad_phase, kinds[i], 0, 10);
      use_without_memory(use_pair_events, kinds[i], 0, 5);
    }
    for (bits = 0; bits <= 16; bits += 8) {
      use_without_memory(use_scan, kinds[i], bits, 2);
    }
  }
  (void)remove("c_test_memory.bvh");
  test_misaligned();
}
