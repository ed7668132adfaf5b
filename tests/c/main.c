#include "check.h"

int failures = 0;

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
  test_bounds();
  test_parity();
  test_callbacks();
  test_files();
  test_errors();
  test_memory();
  test_exceptions();
  if (failures != 0) fprintf(stderr, "%d checks failed\n", failures);
  return failures != 0;
}
