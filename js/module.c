// What bvh.js passes to the C API, as JavaScript has no structs: each
// function fills a struct, and returns its address. bvh.js calls the
// functions of the C API by their names.
#include <emscripten.h>
#include <stdint.h>

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

EMSCRIPTEN_KEEPALIVE const hs_pair_options* pair_options(float margin) {
  static hs_pair_options options;
  hs_pair_options_default(&options, sizeof options);
  options.margin = margin;
  return &options;
}

EMSCRIPTEN_KEEPALIVE const hs_query_options* sphere_options(void) {
  static hs_query_options options;
  hs_query_options_default(&options, sizeof options);
  options.shape = HS_SHAPE_SPHERE;
  return &options;
}
