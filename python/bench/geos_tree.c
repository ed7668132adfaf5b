// GEOS's STRtree, as a library that calls it from C would use it: with the
// reentrant API, and with callbacks that only store their result. compare.py
// compiles this file and calls it through ctypes, on one thread. Without memory
// it aborts.
#include <geos_c.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static GEOSContextHandle_t context;

static void* Made(void* made) {
  if (made == NULL) abort();
  return made;
}

// Rectangles, made before anything is timed: callers of GEOS have geometries.
typedef struct {
  const double* boxes;  // min x, min y, max x, max y; the caller's
  size_t count;
  GEOSGeometry* geometries[];
} Rectangles;

const char* geos_version(void) { return GEOSversion(); }

Rectangles* geos_rectangles(const double* boxes, size_t count) {
  if (context == NULL) context = Made(GEOS_init_r());
  Rectangles* made =
      Made(malloc(sizeof(Rectangles) + count * sizeof(GEOSGeometry*)));
  made->boxes = boxes;
  made->count = count;
  for (size_t i = 0; i < count; ++i, boxes += 4) {
    made->geometries[i] = Made(GEOSGeom_createRectangle_r(
        context, boxes[0], boxes[1], boxes[2], boxes[3]));
  }
  return made;
}

void geos_rectangles_free(Rectangles* rectangles) {
  for (size_t i = 0; i < rectangles->count; ++i) {
    GEOSGeom_destroy_r(context, rectangles->geometries[i]);
  }
  free(rectangles);
}

static void Ignore(void* item, void* data) {
  (void)item;
  (void)data;
}

// The items are ids. They are stored plus 1, because nearest returns a null
// pointer for an error.
GEOSSTRtree* geos_tree(const Rectangles* objects) {
  const size_t node_capacity = 10;  // Shapely's and GEOS's own
  GEOSSTRtree* tree = Made(GEOSSTRtree_create_r(context, node_capacity));
  for (size_t i = 0; i < objects->count; ++i) {
    GEOSSTRtree_insert_r(context, tree, objects->geometries[i], (void*)(i + 1));
  }
  // The first query builds the tree.
  GEOSSTRtree_query_r(context, tree, objects->geometries[0], Ignore, NULL);
  return tree;
}

void geos_tree_free(GEOSSTRtree* tree) { GEOSSTRtree_destroy_r(context, tree); }

typedef struct {
  int64_t (*pairs)[2];  // of a probe and an object
  size_t count, capacity;
  // Of the query.
  GEOSGeometry* const* objects;
  const GEOSPreparedGeometry* probe;  // null without a distance
  double within;
  int64_t row;
} Pairs;

static void Append(Pairs* pairs, int64_t id) {
  if (pairs->count == pairs->capacity) {
    pairs->capacity = pairs->capacity * 2 + 1024;
    pairs->pairs =
        Made(realloc(pairs->pairs, pairs->capacity * sizeof(*pairs->pairs)));
  }
  pairs->pairs[pairs->count][0] = pairs->row;
  pairs->pairs[pairs->count++][1] = id;
}

static void AppendNear(void* item, void* data) {
  Pairs* pairs = data;
  const int64_t id = (int64_t)(intptr_t)item - 1;
  const int is_near =
      pairs->probe == NULL ||
      GEOSPreparedDistanceWithin_r(context, pairs->probe, pairs->objects[id],
                                   pairs->within);
  if (is_near) Append(pairs, id);
}

// Returns the number of pairs of a probe and an object that overlap, or that
// are at most `within` apart if this is not 0, in *found, which the caller
// frees.
size_t geos_join(GEOSSTRtree* tree, const Rectangles* objects,
                 const Rectangles* probes, double within,
                 int64_t (**found)[2]) {
  Pairs pairs = {.objects = objects->geometries, .within = within};
  for (size_t i = 0; i < probes->count; ++i) {
    pairs.row = (int64_t)i;
    if (within == 0) {
      GEOSSTRtree_query_r(context, tree, probes->geometries[i], AppendNear,
                          &pairs);
      continue;
    }
    const double* box = probes->boxes + 4 * i;
    GEOSGeometry* around = Made(
        GEOSGeom_createRectangle_r(context, box[0] - within, box[1] - within,
                                   box[2] + within, box[3] + within));
    pairs.probe = GEOSPrepare_r(context, probes->geometries[i]);
    GEOSSTRtree_query_r(context, tree, around, AppendNear, &pairs);
    GEOSPreparedGeom_destroy_r(context, pairs.probe);
    GEOSGeom_destroy_r(context, around);
  }
  *found = pairs.pairs;
  return pairs.count;
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
size_t geos_nearest(GEOSSTRtree* tree, const Rectangles* objects,
                    const Rectangles* probes, int with_ties,
                    int64_t (**found)[2]) {
  Pairs pairs = {0};
  for (size_t i = 0; i < probes->count; ++i) {
    pairs.row = (int64_t)i;
    Nearest nearest = {objects->boxes, probes->boxes + 4 * i,
                       with_ties ? &pairs : NULL, pairs.count, INFINITY};
    const void* item = GEOSSTRtree_nearest_generic_r(
        context, tree, probes->geometries[i], probes->geometries[i],
        BoxDistance, &nearest);
    if (!with_ties) Append(&pairs, (int64_t)(intptr_t)item - 1);
  }
  *found = pairs.pairs;
  return pairs.count;
}
