// A program in C that calls the library, and links nothing else by itself.
#include <halfspace/c/halfspace.h>
#include <stdio.h>

int main(void) {
  const float boxes[] = {0, 0, 1, 1, 5, 5, 6, 6};
  const float query[] = {4, 4, 7, 7};
  const hs_columns objects = hs_float_rows(boxes, 2, 4);
  const hs_columns queries = hs_float_rows(query, 1, 4);
  hs_bvh_config config;
  hs_bvh* bvh = NULL;
  uint32_t id = 0;
  size_t total = 0;
  hs_bvh_config_default(&config, sizeof config);
  config.kind = HS_BOX2;
  if (hs_bvh_create(&config, &objects, &bvh) != HS_OK ||
      hs_bvh_query(bvh, &queries, NULL, &id, 1, NULL, &total) != HS_OK) {
    fprintf(stderr, "%s\n", hs_last_error());
    return 1;
  }
  hs_bvh_destroy(bvh);
  // An error, which is an exception inside the library.
  if (hs_bvh_create(NULL, &objects, &bvh) != HS_INVALID_ARGUMENT) return 1;
  return total == 1 && id == 1 ? 0 : 1;
}
