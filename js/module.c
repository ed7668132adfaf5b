// What bvh.js passes to the C API, as JavaScript has no structs: each
// function fills a struct, and returns its address. bvh.js calls the
// functions of the C API by their names.
#include <emscripten.h>
#include <stdint.h>
#include <string.h>

#include "halfspace/c/halfspace.h"

// Rows of `values` numbers. Each slot is a struct of its own.
EMSCRIPTEN_KEEPALIVE const hs_columns* rows(int slot, int is_double,
                                            const void* data, size_t count,
                                            size_t values) {
  static hs_columns columns[16];
  columns[slot] = is_double ? hs_double_rows(data, count, values)
                            : hs_float_rows(data, count, values);
  return &columns[slot];
}

EMSCRIPTEN_KEEPALIVE const hs_bvh_config* config(int dims, int is_fast,
                                                 const float* query_extents) {
  static hs_bvh_config config;
  hs_bvh_config_default(&config, sizeof config);
  config.kind = dims == 2 ? HS_BOX2 : HS_BOX3;
  config.quality = is_fast ? HS_QUALITY_FAST : HS_QUALITY_HIGH;
  config.query_extents = query_extents;
  return &config;
}

// Where find_pairs() writes. size_t cannot count the pairs of all BVHs, so the
// search ends when there are more than memory has bytes for.
static hs_id_pair* found;
static size_t room, total;

static hs_visit add_pairs(void* context, const hs_id_pair* pairs,
                          size_t count) {
  (void)context;
  total += count;
  if (total <= room)
    memcpy(found + total - count, pairs, count * sizeof *pairs);
  return total <= SIZE_MAX / sizeof *pairs ? HS_CONTINUE : HS_STOP;
}

// The pairs of a BVH or, if b is not null, those of two. If there are more than
// `size`, some are not written.
EMSCRIPTEN_KEEPALIVE hs_status find_pairs(const hs_bvh* a, const hs_bvh* b,
                                          float margin, hs_id_pair* pairs,
                                          size_t size, size_t* count) {
  hs_pair_options options;
  hs_pair_options_default(&options, sizeof options);
  options.margin = margin;
  found = pairs;
  room = size;
  total = 0;
  const hs_status status =
      b == NULL ? hs_bvh_pairs_each(a, &options, add_pairs, NULL)
                : hs_bvh_join_each(a, b, &options, add_pairs, NULL);
  *count = total;
  return status;
}

EMSCRIPTEN_KEEPALIVE const hs_query_options* sphere_options(void) {
  static hs_query_options options;
  hs_query_options_default(&options, sizeof options);
  options.shape = HS_SHAPE_SPHERE;
  return &options;
}
