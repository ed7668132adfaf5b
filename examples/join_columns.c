// A join as an operator of a database does it, in C: columns of doubles are
// pushed in batches, and the rows of another table are probed in batches. The
// exact test of the doubles is the caller's.
#include <halfspace/c/halfspace.h>
#include <stdio.h>
#include <stdlib.h>

enum { BATCH = 2048, ROWS = 10000 };

// A table of boxes: a column for each limit.
typedef struct table {
  double* limit[4];  // min x, min y, max x, max y
} table;

// Rows begin ... begin + count - 1, which are not copied.
static hs_columns columns_of(const table* rows, size_t begin, size_t count) {
  hs_columns columns = {HS_FLOAT64, 0, 1, {NULL}};
  columns.count = count;
  for (int v = 0; v < 4; ++v) columns.column[v] = rows->limit[v] + begin;
  return columns;
}

typedef struct join {
  const table* build;
  const table* probe;
  size_t first_row;  // of the batch that is probed
  size_t candidates;
  size_t pairs;
} join;

// Bounds are floats, so some candidates only seem to touch.
static hs_visit on_candidates(void* context, size_t query, const uint32_t* ids,
                              size_t count) {
  join* const its = context;
  double* const* const a = its->build->limit;
  double* const* const b = its->probe->limit;
  const size_t row = its->first_row + query;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t id = ids[i];
    its->pairs += a[0][id] <= b[2][row] && b[0][row] <= a[2][id] &&
                  a[1][id] <= b[3][row] && b[1][row] <= a[3][id];
  }
  its->candidates += count;
  return HS_CONTINUE;
}

static int fail(void) {
  fprintf(stderr, "%s\n", hs_last_error());
  return 1;
}

static table squares(double first, double step, double side) {
  table rows;
  for (int v = 0; v < 4; ++v) {
    rows.limit[v] = malloc(ROWS * sizeof(double));
    if (rows.limit[v] == NULL) exit(1);
  }
  for (size_t i = 0; i < ROWS; ++i) {
    rows.limit[0][i] = first + step * (double)(i % 100);
    rows.limit[1][i] = first + step * (double)(i / 100);
    rows.limit[2][i] = rows.limit[0][i] + side;
    rows.limit[3][i] = rows.limit[1][i] + side;
  }
  return rows;
}

int main(void) {
  const table build = squares(0, 0.1, 0.1);
  const table probe = squares(0.05, 0.1, 0.0499999999);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  hs_bvh_config config;
  hs_bvh_config_default(&config, sizeof config);
  config.kind = HS_BOX2;
  if (hs_builder_create(&config, &builder) != HS_OK) return fail();
  for (size_t i = 0; i < ROWS; i += BATCH) {
    const hs_columns batch =
        columns_of(&build, i, i + BATCH < ROWS ? BATCH : ROWS - i);
    if (hs_builder_push(builder, &batch) != HS_OK) return fail();
  }
  if (hs_builder_finish(builder, &bvh) != HS_OK) return fail();
  hs_builder_destroy(builder);

  join its = {&build, &probe, 0, 0, 0};
  for (size_t i = 0; i < ROWS; i += BATCH) {
    const hs_columns batch =
        columns_of(&probe, i, i + BATCH < ROWS ? BATCH : ROWS - i);
    its.first_row = i;
    if (hs_bvh_query_each(bvh, &batch, NULL, on_candidates, &its) != HS_OK) {
      return fail();
    }
  }
  hs_bvh_destroy(bvh);
  printf("%zu pairs of %zu candidates\n", its.pairs, its.candidates);
  for (int v = 0; v < 4; ++v) {
    free(build.limit[v]);
    free(probe.limit[v]);
  }
  return 0;
}
