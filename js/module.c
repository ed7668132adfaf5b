// The functions of the WebAssembly module: those of the C API for boxes, with
// numbers as arguments alone. What returns a size returns FAILED if the call
// failed, and then hs_last_error_argument() and hs_last_error_reason() say why.
#include <emscripten.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "halfspace/c/halfspace.h"

static const size_t FAILED = SIZE_MAX;

// The arguments and results of calls of one query.
static struct One {
  double values[8];
  float floats[8];
  size_t total;
  uint32_t id;
  float t;
} one;

EMSCRIPTEN_KEEPALIVE void* one_values(void) { return one.values; }
EMSCRIPTEN_KEEPALIVE void* one_result(void) { return &one.id; }

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

EMSCRIPTEN_KEEPALIVE hs_bvh* bvh_create(int dims, int is_double,
                                        const void* boxes, size_t count,
                                        int is_fast) {
  const hs_bvh_config config = ConfigOf(dims, is_fast);
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  hs_bvh* bvh = NULL;
  return hs_bvh_create(&config, &columns, &bvh) == HS_OK ? bvh : NULL;
}

EMSCRIPTEN_KEEPALIVE void bvh_destroy(hs_bvh* bvh) { hs_bvh_destroy(bvh); }

EMSCRIPTEN_KEEPALIVE size_t bvh_size(const hs_bvh* bvh) {
  size_t size;
  return hs_bvh_size(bvh, &size) == HS_OK ? size : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_id_limit(const hs_bvh* bvh) {
  size_t limit;
  return hs_bvh_id_limit(bvh, &limit) == HS_OK ? limit : FAILED;
}

EMSCRIPTEN_KEEPALIVE const float* bvh_bounds(const hs_bvh* bvh) {
  return hs_bvh_bounds(bvh, one.floats) == HS_OK ? one.floats : NULL;
}

// The number of results of all queries, of which `room` are written.
EMSCRIPTEN_KEEPALIVE size_t bvh_query(const hs_bvh* bvh, int dims,
                                      int is_double, const void* boxes,
                                      size_t count, uint32_t* ids, size_t room,
                                      size_t* offsets) {
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  const hs_status status =
      hs_bvh_query(bvh, &columns, NULL, ids, room, offsets, &one.total);
  return status == HS_OK ? one.total : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_nearest(const hs_bvh* bvh, int dims,
                                        int is_double, const void* points,
                                        size_t count, size_t k,
                                        float max_distance, uint32_t* ids,
                                        float* distances) {
  const hs_columns columns = Rows(is_double, points, count, (size_t)dims);
  const hs_status status = hs_bvh_nearest_to_points(
      bvh, &columns, k, max_distance, NULL, ids, distances);
  return status == HS_OK ? count : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_raycast(const hs_bvh* bvh, int dims,
                                        const float* rays, size_t count,
                                        uint32_t* ids, float* ts) {
  const hs_columns columns = hs_float_rows(rays, count, (size_t)(2 * dims + 1));
  return hs_bvh_raycast(bvh, &columns, 0, NULL, ids, ts) == HS_OK ? count
                                                                  : FAILED;
}

// The pairs of a BVH, or with another one, `b`, those of an object of each.
EMSCRIPTEN_KEEPALIVE size_t bvh_pairs(const hs_bvh* bvh, const hs_bvh* b,
                                      float margin, hs_id_pair* pairs,
                                      size_t room) {
  hs_pair_options options;
  hs_pair_options_default(&options, sizeof options);
  options.margin = margin;
  const hs_status status =
      b != NULL ? hs_bvh_join(bvh, b, &options, pairs, room, &one.total)
                : hs_bvh_pairs(bvh, &options, pairs, room, &one.total);
  return status == HS_OK ? one.total : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_insert(hs_bvh* bvh, int dims, int is_double,
                                       const void* boxes, size_t count,
                                       uint32_t* ids) {
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  return hs_bvh_insert(bvh, &columns, ids) == HS_OK ? count : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_set(hs_bvh* bvh, int dims, int is_double,
                                    const void* boxes, size_t count,
                                    const uint32_t* ids) {
  const hs_columns columns = Rows(is_double, boxes, count, (size_t)(2 * dims));
  return hs_bvh_set(bvh, ids, &columns) == HS_OK ? count : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_erase(hs_bvh* bvh, const uint32_t* ids,
                                      size_t count) {
  return hs_bvh_erase(bvh, ids, count) == HS_OK ? count : FAILED;
}

EMSCRIPTEN_KEEPALIVE size_t bvh_rebuild(hs_bvh* bvh) {
  return hs_bvh_rebuild(bvh, NULL) == HS_OK ? 0 : FAILED;
}

// Writes where the bytes are to one_result(). They stay valid until the BVH
// changes.
EMSCRIPTEN_KEEPALIVE size_t bvh_blob(const hs_bvh* bvh) {
  const void* data;
  if (hs_bvh_blob(bvh, &data, &one.total) != HS_OK) return FAILED;
  one.id = (uint32_t)(uintptr_t)data;
  return one.total;
}

// The dimensions of the boxes in a blob, or 0 if it has other bounds.
EMSCRIPTEN_KEEPALIVE size_t blob_dimensions(const void* data, size_t size) {
  hs_kind kind;
  if (hs_blob_kind(data, size, &kind) != HS_OK) return FAILED;
  return kind == HS_BOX2 ? 2 : kind == HS_BOX3 ? 3 : 0;
}

EMSCRIPTEN_KEEPALIVE hs_bvh* bvh_from_blob(int dims, const void* data,
                                           size_t size) {
  const hs_bvh_config config = ConfigOf(dims, 0);
  hs_bvh* bvh = NULL;
  return hs_bvh_from_blob(&config, data, size, &bvh) == HS_OK ? bvh : NULL;
}

EMSCRIPTEN_KEEPALIVE const char* error_argument(void) {
  return hs_last_error_argument();
}
EMSCRIPTEN_KEEPALIVE const char* error_reason(void) {
  return hs_last_error_reason();
}
EMSCRIPTEN_KEEPALIVE const char* version(void) { return hs_version(); }
