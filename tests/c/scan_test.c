// Flat scans, of floats and quantized, against the test of two bounds.
#include <math.h>
#include <stdlib.h>

#include "check.h"

enum { OBJECTS = 700, QUERIES = 300, VALUES = 8 };

static float objects[OBJECTS * VALUES];
static float queries[QUERIES * VALUES];

static void test_scan(hs_kind kind, int bits) {
  enum { WORDS = (OBJECTS + 63) / 64 };
  static uint64_t masks[QUERIES * WORDS];
  static size_t counts[QUERIES];
  static uint32_t any[QUERIES];
  static size_t offsets[QUERIES + 1];
  static uint32_t indices[QUERIES * OBJECTS];
  static uint32_t of_queries[QUERIES * OBJECTS];
  static uint32_t of_objects[QUERIES * OBJECTS];
  const size_t values = hs_bound_values(kind);
  const hs_scan_config config = scan_config_of(kind, bits);
  hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  hs_columns asked = hs_float_rows(queries, QUERIES, values);
  hs_scan_options options;
  hs_scan* scan = NULL;
  size_t size = 0;
  size_t total = 0;
  size_t pairs = 0;
  size_t next = 0;
  size_t q;
  size_t i;
  random_bounds(kind, OBJECTS, 0.2f, 1, objects);
  random_bounds(kind, QUERIES, 0.2f, 2, queries);
  objects[3 * values] = NAN;
  for (i = 0; i < values; ++i) {
    objects[5 * values + i] = i < values / 2 ? INFINITY : -INFINITY;
  }
  CHECK_OK(hs_scan_create(&config, &columns, &scan));
  CHECK_OK(hs_scan_size(scan, &size));
  CHECK(size == OBJECTS && hs_mask_words(size) == WORDS);

  CHECK_OK(hs_scan_masks(scan, &asked, NULL, masks, QUERIES * WORDS));
  CHECK_OK(hs_scan_counts(scan, &asked, NULL, counts));
  CHECK_OK(hs_scan_any(scan, &asked, NULL, any));
  CHECK_OK(hs_scan_indices(scan, &asked, NULL, indices, QUERIES * OBJECTS,
                           offsets, &total));
  CHECK_OK(hs_scan_pairs(scan, &asked, NULL, of_queries, of_objects,
                         QUERIES * OBJECTS, &pairs));
  CHECK(pairs == total && offsets[0] == 0 && offsets[QUERIES] == total);
  for (q = 0; q < QUERIES; ++q) {
    size_t count = 0;
    for (i = 0; i < OBJECTS; ++i) {
      const int expected =
          survives(kind, objects + i * values, queries + q * values);
      CHECK((int)(masks[q * WORDS + i / 64] >> (i % 64) & 1) == expected);
      if (!expected) continue;
      CHECK(indices[next++] == i);
      ++count;
    }
    CHECK(counts[q] == count && offsets[q + 1] == next);
    CHECK((any[q] == HS_NO_ID) == (count == 0));
    CHECK(count == 0 ||
          survives(kind, objects + any[q] * values, queries + q * values));
  }
  CHECK(total > QUERIES);
  for (i = 0; i < pairs; ++i) {
    CHECK(survives(kind, objects + of_objects[i] * values,
                   queries + of_queries[i] * values));
  }

  // One after another; and queries that are not rows.
  CHECK_OK(hs_scan_options_default(&options, sizeof(options)));
  asked.count = 260;
  asked.stride = 0;
  CHECK_OK(hs_scan_pairs(scan, &asked, NULL, of_queries, of_objects,
                         QUERIES * OBJECTS, &pairs));
  for (i = 0; i < pairs; i += 50) {
    uint32_t query = 0;
    uint32_t object = 0;
    options.skip = i;
    CHECK_OK(hs_scan_pairs(scan, &asked, &options, &query, &object, 1, &total));
    CHECK(total == pairs && query == of_queries[i] && object == of_objects[i]);
    CHECK_OK(hs_scan_indices(scan, &asked, &options, indices, 1, NULL, &total));
    CHECK(total == pairs);
    CHECK(i >= counts[0] || indices[0] == of_objects[i]);
  }
  CHECK(pairs == 260 * counts[0] && of_queries[pairs - 1] == 259);

  // A range of objects.
  options.skip = 0;
  options.begin = 64;
  options.end = 128;
  options.target = hs_target_name(hs_target_count() - 1);
  asked = hs_float_rows(queries, QUERIES, values);
  CHECK_OK(hs_scan_masks(scan, &asked, &options, masks, QUERIES));
  CHECK_OK(hs_scan_indices(scan, &asked, &options, indices, 1, NULL, &total));
  for (q = 0, next = 0; q < QUERIES; ++q) {
    for (i = 64; i < 128; ++i) {
      const int expected =
          survives(kind, objects + i * values, queries + q * values);
      next += (size_t)expected;
      CHECK((int)(masks[q] >> (i - 64) & 1) == expected);
    }
  }
  CHECK(total == next);
  hs_scan_destroy(scan);
}

// Objects and queries of doubles, each rounded outward: those that touch only
// as floats survive.
static void test_doubles(int bits) {
  const double boxes[] = {0, 0, 0.1, 1, 0.2, 0, 1, 1};
  const double query[] = {0.10000000149, 0, 0.15, 1};
  const hs_scan_config config = scan_config_of(HS_BOX2, bits);
  hs_columns columns = hs_double_rows(boxes, 2, 4);
  hs_columns asked = hs_double_rows(query, 1, 4);
  hs_scan* scan = NULL;
  size_t count = 0;
  CHECK_OK(hs_scan_create(&config, &columns, &scan));
  CHECK_OK(hs_scan_counts(scan, &asked, NULL, &count));
  CHECK(count == 1);
  hs_scan_destroy(scan);
}

void test_scans(void) {
  int kind;
  int bits;
  for (bits = 0; bits <= 16; bits += 8) {
    hs_scan* scan = NULL;
    hs_columns none = hs_float_rows(NULL, 0, 6);
    const hs_scan_config config = scan_config_of(HS_BOX3, bits);
    size_t total = 1;
    for (kind = 0; kind < KINDS; ++kind) test_scan(kind_of(kind), bits);
    test_doubles(bits);
    CHECK_OK(hs_scan_create(&config, &none, &scan));
    CHECK_OK(hs_scan_masks(scan, &none, NULL, NULL, 0));
    CHECK_OK(hs_scan_indices(scan, &none, NULL, NULL, 0, NULL, &total));
    CHECK(total == 0);
    hs_scan_destroy(scan);
  }
  hs_scan_destroy(NULL);
}
