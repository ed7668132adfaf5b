#include <stdlib.h>

#include "check.h"

int failures = 0;

void random_bounds(hs_kind kind, size_t count, float side, uint32_t seed,
                   float* bounds) {
  const size_t dims = dims_of(kind);
  float* const boxes = malloc(count * 2 * dims * sizeof(float));
  hs_columns columns = hs_float_rows(boxes, count, 2 * dims);
  size_t i;
  size_t k;
  for (i = 0; i < count; ++i) {
    for (k = 0; k < dims; ++k) {
      float* const box = boxes + i * 2 * dims;
      box[k] = random_float(&seed);
      box[dims + k] = box[k] + side * random_float(&seed);
    }
  }
  CHECK_OK(hs_bound_boxes(kind, &columns, NULL, bounds, NULL));
  free(boxes);
}

static void test_version_and_targets(void) {
  const char* chosen = NULL;
  size_t i;
  int is_listed = 0;
  CHECK(strcmp(hs_version(), HALFSPACE_VERSION_STRING) == 0);
  CHECK(strcmp(hs_last_error(), "") == 0);
  CHECK(strcmp(hs_status_name(HS_CORRUPT), "HS_CORRUPT") == 0);
  CHECK(strcmp(hs_status_name((hs_status)99), "unknown status") == 0);
  CHECK_OK(hs_chosen_target(&chosen));
  CHECK(hs_target_count() > 0);
  for (i = 0; i < hs_target_count(); ++i) {
    is_listed |= strcmp(hs_target_name(i), chosen) == 0;
  }
  CHECK(is_listed);
  CHECK(hs_target_name(hs_target_count()) == NULL);
}

int main(void) {
  test_version_and_targets();
  test_parity();
  test_callbacks();
  test_files();
  test_errors();
  test_memory();
  test_exceptions();
  if (failures != 0) fprintf(stderr, "%d checks failed\n", failures);
  return failures != 0;
}
