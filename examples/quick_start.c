// Which of two boxes does a query touch?
#include <halfspace/c/halfspace.h>
#include <stdio.h>

int main(void) {
  const float boxes[] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};
  const float query[] = {0.5f, 0.5f, -1, 0.5f, 0.5f, 1};
  const hs_columns objects = hs_float_rows(boxes, 2, 6);
  const hs_columns queries = hs_float_rows(query, 1, 6);
  hs_bvh_config config;
  hs_bvh_config_default(&config, sizeof config);
  config.kind = HS_BOX3;
  hs_bvh* bvh = NULL;
  uint32_t ids[2];
  size_t total = 0;
  if (hs_bvh_create(&config, &objects, &bvh) != HS_OK ||
      hs_bvh_query(bvh, &queries, NULL, ids, 2, NULL, &total) != HS_OK) {
    fprintf(stderr, "%s\n", hs_last_error());
    hs_bvh_destroy(bvh);
    return 1;
  }
  for (size_t i = 0; i < total; ++i)
    printf("object %u may be touched\n", ids[i]);
  hs_bvh_destroy(bvh);
}
