// GEOS's STRtree, as a library that calls it from C would use it: with the
// reentrant API, and with callbacks that only store their result. compare.py
// compiles this file and calls it through ctypes.
//
// Every function that can fail returns a null pointer or -1.
#include <geos_c.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

// Rectangles, made before anything is timed: callers of GEOS have geometries.
typedef struct {
  GEOSContextHandle_t context;
  const double* boxes;  // min x, min y, max x, max y; the caller's
  size_t count;
  GEOSGeometry** geometries;
} Rectangles;

const char* geos_version(void) { return GEOSversion(); }

void geos_rectangles_free(Rectangles* rectangles) {
  for (size_t i = 0; i < rectangles->count; ++i) {
    GEOSGeom_destroy_r(rectangles->context, rectangles->geometries[i]);
  }
  free(rectangles->geometries);
  GEOS_finish_r(rectangles->context);
  free(rectangles);
}

Rectangles* geos_rectangles(const double* boxes, size_t count) {
  Rectangles* made = malloc(sizeof(Rectangles));
  if (made == NULL) return NULL;
  made->context = GEOS_init_r();
  made->boxes = boxes;
  made->count = 0;
  made->geometries = malloc(count * sizeof(GEOSGeometry*));
  for (; made->geometries != NULL && made->count < count; ++made->count) {
    const double* box = boxes + 4 * made->count;
    GEOSGeometry* geometry = GEOSGeom_createRectangle_r(made->context, box[0],
                                                        box[1], box[2], box[3]);
    if (geometry == NULL) break;
    made->geometries[made->count] = geometry;
  }
  if (made->count == count) return made;
  geos_rectangles_free(made);
  return NULL;
}

static void Ignore(void* item, void* data) {
  (void)item;
  (void)data;
}

void geos_tree_free(GEOSSTRtree* tree, const Rectangles* objects) {
  GEOSSTRtree_destroy_r(objects->context, tree);
}

// The items are ids. They are stored plus 1, because nearest returns a null
// pointer for an error.
GEOSSTRtree* geos_tree(const Rectangles* objects) {
  const size_t node_capacity = 10;  // Shapely's and GEOS's own
  GEOSSTRtree* tree = GEOSSTRtree_create_r(objects->context, node_capacity);
  if (tree == NULL || objects->count == 0) return tree;
  for (size_t i = 0; i < objects->count; ++i) {
    GEOSSTRtree_insert_r(objects->context, tree, objects->geometries[i],
                         (void*)(i + 1));
  }
  // The first query builds the tree.
  GEOSSTRtree_query_r(objects->context, tree, objects->geometries[0], Ignore,
                      NULL);
  return tree;
}

typedef struct {
  int64_t* rows;
  int64_t* ids;
  size_t count, capacity;
  int has_failed;
  // Of the query.
  GEOSContextHandle_t context;
  GEOSGeometry* const* objects;
  const GEOSPreparedGeometry* probe;  // null without a distance
  double within;
  int64_t row;
} Pairs;

static void Append(Pairs* pairs, int64_t id) {
  if (pairs->count == pairs->capacity) {
    const size_t capacity = pairs->capacity * 2 + 1024;
    int64_t* rows = realloc(pairs->rows, capacity * sizeof(int64_t));
    if (rows != NULL) pairs->rows = rows;
    int64_t* ids = realloc(pairs->ids, capacity * sizeof(int64_t));
    if (ids != NULL) pairs->ids = ids;
    pairs->has_failed |= rows == NULL || ids == NULL;
    if (pairs->has_failed) return;
    pairs->capacity = capacity;
  }
  pairs->rows[pairs->count] = pairs->row;
  pairs->ids[pairs->count++] = id;
}

static void AppendNear(void* item, void* data) {
  Pairs* pairs = data;
  const int64_t id = (int64_t)(intptr_t)item - 1;
  const int is_near =
      pairs->probe == NULL ||
      GEOSPreparedDistanceWithin_r(pairs->context, pairs->probe,
                                   pairs->objects[id], pairs->within);
  if (is_near) Append(pairs, id);
}

static int64_t Finish(const Pairs* pairs, int64_t** rows, int64_t** ids) {
  *rows = pairs->rows;
  *ids = pairs->ids;
  return pairs->has_failed ? -1 : (int64_t)pairs->count;
}

// Returns the number of pairs of a probe and an object that overlap, or that
// are at most `within` apart if this is not 0, in *rows and *ids, which the
// caller frees.
int64_t geos_join(GEOSSTRtree* tree, const Rectangles* objects,
                  const Rectangles* probes, double within, int64_t** rows,
                  int64_t** ids) {
  Pairs pairs = {.context = probes->context,
                 .objects = objects->geometries,
                 .within = within};
  for (size_t i = 0; i < probes->count; ++i) {
    pairs.row = (int64_t)i;
    if (within == 0) {
      GEOSSTRtree_query_r(pairs.context, tree, probes->geometries[i],
                          AppendNear, &pairs);
      continue;
    }
    const double* box = probes->boxes + 4 * i;
    GEOSGeometry* around = GEOSGeom_createRectangle_r(
        pairs.context, box[0] - within, box[1] - within, box[2] + within,
        box[3] + within);
    pairs.probe = GEOSPrepare_r(pairs.context, probes->geometries[i]);
    GEOSSTRtree_query_r(pairs.context, tree, around, AppendNear, &pairs);
    GEOSPreparedGeom_destroy_r(pairs.context, pairs.probe);
    GEOSGeom_destroy_r(pairs.context, around);
  }
  return Finish(&pairs, rows, ids);
}

static double Gap(double min_a, double max_a, double min_b, double max_b) {
  return fmax(0, fmax(min_a - max_b, min_b - max_a));
}

typedef struct {
  const double* boxes;
  const double* probe;
  Pairs* pairs;  // all that are as near as any before them
  size_t first;  // of this probe
  double least;
} Nearest;

static int BoxDistance(const void* a, const void* b, double* distance,
                       void* data) {
  (void)b;  // is the probe
  Nearest* nearest = data;
  const int64_t id = (intptr_t)a - 1;
  const double* box = nearest->boxes + 4 * id;
  const double* probe = nearest->probe;
  const double x = Gap(box[0], box[2], probe[0], probe[2]);
  const double y = Gap(box[1], box[3], probe[1], probe[3]);
  *distance = sqrt(x * x + y * y);
  if (nearest->pairs == NULL) return 1;
  if (*distance < nearest->least) {
    nearest->least = *distance;
    nearest->pairs->count = nearest->first;
  }
  if (*distance == nearest->least) {
    Append(nearest->pairs, id);
    // GEOS goes on to others that are as near, as in Shapely 2.
    *distance += 1e-6;
  }
  return 1;
}

// The same for the nearest object of each probe, or for all that are as near.
int64_t geos_nearest(GEOSSTRtree* tree, const Rectangles* objects,
                     const Rectangles* probes, int with_ties, int64_t** rows,
                     int64_t** ids) {
  Pairs pairs = {0};
  for (size_t i = 0; i < probes->count; ++i) {
    pairs.row = (int64_t)i;
    Nearest nearest = {objects->boxes, probes->boxes + 4 * i,
                       with_ties ? &pairs : NULL, pairs.count, INFINITY};
    const void* item = GEOSSTRtree_nearest_generic_r(
        probes->context, tree, probes->geometries[i], probes->geometries[i],
        BoxDistance, &nearest);
    pairs.has_failed |= item == NULL;
    if (!with_ties) Append(&pairs, (int64_t)(intptr_t)item - 1);
  }
  return Finish(&pairs, rows, ids);
}
