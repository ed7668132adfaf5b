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

static const char kPath[] = "c_test_memory.bvh";
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
  const hs_id_pair pairs[] = {{0, 1}, {0, 2}};
  const hs_allocator allocator = allocator_of(its);
  hs_pair_events* events = NULL;
  (void)kind;
  if (!has_done(its, hs_pair_events_create(&allocator, &events))) return;
  (void)has_done(its, hs_pair_events_load(events, pairs, 2));
  hs_pair_events_destroy(events);
}

// In memory, or in a file by runs.
static void use_builder(hs_kind kind, memory* its, int is_in_file) {
  const size_t values = hs_bound_values(kind);
  const hs_columns floats = hs_float_rows(objects, HALF, values);
  const hs_columns wide = hs_double_rows(doubles, HALF, values);
  hs_bvh_config config = bvh_config_of(kind);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  size_t pushed = 0;
  config.allocator = allocator_of(its);
  if (!has_done(its, is_in_file ? hs_builder_create_file(&config, kPath, 10000,
                                                         &builder)
                                : hs_builder_create(&config, &builder))) {
    return;
  }
  pushed += (size_t)has_done(its, hs_builder_push(builder, &floats));
  pushed += (size_t)has_done(its, hs_builder_push(builder, &wide));
  if (has_done(its, hs_builder_finish(builder, &bvh))) {
    CHECK(size_of(bvh) == pushed * HALF);
    hs_bvh_destroy(bvh);
  }
  hs_builder_destroy(builder);
}
static void use_builders(hs_kind kind, memory* its) {
  use_builder(kind, its, 0);
  use_builder(kind, its, 1);
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
    CHECK_OK(hs_builder_create_file(&config, kPath, limits[i], &builder));
    CHECK_OK(hs_builder_push(builder, &columns));
    before = its.bytes;
    CHECK_OK(hs_builder_finish(builder, &bvh));
    CHECK(its.most <= before + limits[i]);
    hs_bvh_destroy(bvh);
    hs_builder_destroy(builder);
    CHECK(its.live == 0);
  }
}

// The changes of a BVH allocate in the C++ library alone, whose tests make each
// without memory.
static void use_bvh(hs_kind kind, memory* its) {
  const hs_columns wide = hs_double_rows(doubles, HALF, hs_bound_values(kind));
  hs_bvh_config config = bvh_config_of(kind);
  hs_bvh* bvh = NULL;
  hs_bvh* copies[3] = {NULL, NULL, NULL};
  const void* blob = NULL;
  size_t bytes = 0;
  size_t i;
  config.allocator = allocator_of(its);
  if (!has_done(its, hs_bvh_create(&config, &wide, &bvh))) return;
  CHECK_OK(hs_bvh_blob(bvh, &blob, &bytes));
  CHECK_OK(hs_bvh_save(bvh, kPath));
  (void)has_done(its, hs_bvh_from_blob(&config, blob, bytes, &copies[0]));
  (void)has_done(its, hs_bvh_load(&config, kPath, &copies[1]));
  (void)has_done(its, hs_bvh_map(&config, kPath, &copies[2]));
  for (i = 0; i < 3; ++i) {
    size_t size = HALF;
    if (copies[i] == NULL) continue;
    // A map becomes a copy.
    if (has_done(its, hs_bvh_erase(copies[i], ids, 1))) --size;
    CHECK(size_of(copies[i]) == size);
    hs_bvh_destroy(copies[i]);
  }
  hs_bvh_destroy(bvh);
}

// Rows of doubles are copied before the C++ library has them.
static void use_broad_phase(hs_kind kind, memory* its) {
  const size_t values = hs_bound_values(kind);
  const hs_columns all = hs_double_rows(doubles, OBJECTS, values);
  const hs_columns moved = hs_double_rows(doubles + values, 100, values);
  hs_broad_phase_config config;
  hs_broad_phase* bodies = NULL;
  hs_broad_phase* copy = NULL;
  size_t expected = 0;
  size_t size = 0;
  CHECK_OK(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = kind;
  config.allocator = allocator_of(its);
  if (!has_done(its, hs_broad_phase_create(&config, &bodies))) return;
  if (has_done(its, hs_broad_phase_insert(bodies, ids, &all, NULL))) {
    expected = OBJECTS;
    (void)has_done(its, hs_broad_phase_move(bodies, ids, &moved));
  }
  if (has_done(its, hs_broad_phase_copy(bodies, &copy))) {
    CHECK_OK(hs_broad_phase_size(copy, &size));
    CHECK(size == expected);
    hs_broad_phase_destroy(copy);
  }
  CHECK_OK(hs_broad_phase_size(bodies, &size));
  CHECK(size == expected);
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
    use_without_memory(use_builders, kinds[k], 6);
    use_without_memory(use_bvh, kinds[k], 8);
    use_without_memory(use_scans, kinds[k], 2);
    if (is_simplex(kinds[k])) continue;
    use_without_memory(use_broad_phase, kinds[k], 5);
    use_without_memory(use_pair_events, kinds[k], 2);
  }
  test_misaligned();
  test_memory_of_a_builder_file();
  (void)remove(kPath);
}
