// The functions of the WebAssembly module that build structs of the C API from
// numbers, as JavaScript has no structs. index.js calls the other functions of
// the C API by their names.
#include <emscripten.h>
#include <stdint.h>

#include "halfspace/c/halfspace.h"

static hs_columns Rows(int is_double, const void* data, size_t count,
                       size_t values) {
  return is_double ? hs_double_rows(data, count, values)
                   : hs_float_rows(data, count, values);
}

static hs_bvh_config ConfigOf(int dims, int is_fast) {
  hs_bvh_config config;
  hs_bvh_config_default(&config, sizeof config);
  config.kind = dims == 2 ? HS_BOX2 : HS_BOX3;
  config.quality = is_fast ? HS_QUALITY_FAST : HS_QUALITY_HIGH;
  return config;
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_create(int dims, int is_double,
                                          const void* boxes, size_t count,
                                          int is_fast, hs_bvh** bvh) {
  const hs_bvh_config config = ConfigOf(dims, is_fast);
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  return hs_bvh_create(&config, &columns, bvh);
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_from_blob(int dims, const void* data,
                                             size_t size, hs_bvh** bvh) {
  const hs_bvh_config config = ConfigOf(dims, 0);
  return hs_bvh_from_blob(&config, data, size, bvh);
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_query(const hs_bvh* bvh, int dims,
                                         int is_double, const void* boxes,
                                         size_t count, uint32_t* ids,
                                         size_t room, size_t* offsets,
                                         size_t* total) {
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  return hs_bvh_query(bvh, &columns, NULL, ids, room, offsets, total);
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_nearest(const hs_bvh* bvh, int dims,
                                           int is_double, const void* points,
                                           size_t count, size_t k,
                                           float max_distance, uint32_t* ids,
                                           float* distances) {
  const hs_columns columns = Rows(is_double, points, count, (size_t)dims);
  return hs_bvh_nearest_to_points(bvh, &columns, k, max_distance, NULL, ids,
                                  distances);
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_raycast(const hs_bvh* bvh, int dims,
                                           const float* rays, size_t count,
                                           uint32_t* ids, float* ts) {
  const hs_columns columns = hs_float_rows(rays, count, (size_t)(2 * dims + 1));
  return hs_bvh_raycast(bvh, &columns, 0, NULL, ids, ts);
}

// The pairs of a BVH, or with another one, `b`, those of an object of each.
EMSCRIPTEN_KEEPALIVE hs_status bvh_pairs(const hs_bvh* bvh, const hs_bvh* b,
                                         float margin, hs_id_pair* pairs,
                                         size_t room, size_t* total) {
  hs_pair_options options;
  hs_pair_options_default(&options, sizeof options);
  options.margin = margin;
  return b != NULL ? hs_bvh_join(bvh, b, &options, pairs, room, total)
                   : hs_bvh_pairs(bvh, &options, pairs, room, total);
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_insert(hs_bvh* bvh, int dims, int is_double,
                                          const void* boxes, size_t count,
                                          uint32_t* ids) {
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  return hs_bvh_insert(bvh, &columns, ids);
}

EMSCRIPTEN_KEEPALIVE hs_status bvh_set(hs_bvh* bvh, int dims, int is_double,
                                       const void* boxes, size_t count,
                                       const uint32_t* ids) {
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  return hs_bvh_set(bvh, ids, &columns);
}
