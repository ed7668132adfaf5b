// halfspace for C: bounds, flat scans, a BVH and a broad phase. C11, and C++11
// or later.
//
//   float boxes[] = {0, 0, 0, 1, 1, 1, /* min x y z, max x y z */
//                    5, 5, 5, 6, 6, 6};
//   hs_bvh_config config;
//   hs_bvh_config_default(&config, sizeof config);
//   config.kind = HS_BOX3;
//   hs_columns objects = hs_float_rows(boxes, 2, 6);
//   hs_bvh* bvh = NULL;
//   if (hs_bvh_create(&config, &objects, &bvh) != HS_OK) {
//     fprintf(stderr, "%s\n", hs_last_error());
//     return 1;
//   }
//   float query[] = {0.5f, 0.5f, 0.5f, 2, 2, 2};
//   hs_columns queries = hs_float_rows(query, 1, 6);
//   uint32_t ids[8];
//   size_t total;
//   hs_status status =
//       hs_bvh_query(bvh, &queries, NULL, ids, 8, NULL, &total);
//   hs_bvh_destroy(bvh);
//   if (status != HS_OK) return 1;
//
// A query returns all objects whose bounds it could touch: an object is left
// out only if a plane separates the two bounds. Bounds that only touch survive,
// and no overlap is missed. Bounds are floats. Doubles are rounded outward.
//
//   cc app.c $(pkg-config --cflags --libs halfspace)
//
// With a static library this names the C++ runtime, too, which a C program
// needs. The library contains these functions unless it was built with
// HALFSPACE_C=OFF, or as a part of a project that does not set HALFSPACE_C.
//
// Status: functions return HS_OK or the reason of the failure, and
// hs_last_error() has the message. A function that fails changes no object and
// stores no handle, except where it says so. Output arrays can then have been
// written in part. No C++ exception leaves a function.
//
// Callbacks, the functions of an allocator and `run` must not leave a call by
// longjmp() or pthread_exit(), and the thread must not be canceled in them. The
// functions of files are no cancellation points.
//
// Pointers must not be null, except where a function says so. An array may be
// null if the call reads or writes no element of it. Arrays must be aligned for
// their type. An output array must not overlap another argument. This is not
// checked.
//
// Results that do not fit: the function fills the array and sets `total` to the
// number of all results. To get the others, call it again with `skip` increased
// by the size of the array. It then searches again. The order of the results is
// the same in every call with the same arguments on an unchanged object. The
// functions with a callback need no array.
//
// Thread safety: functions that take a const handle can run at the same time. A
// function that takes another handle needs exclusive access, except those of
// hs_broad_phase, which say so. Queries of scans and hierarchies allocate
// nothing, except those of the pairs of a set, take no lock and use up to 64
// KiB of stack. The floating-point mode of the calling thread has the effects
// that reject.h and bvh.h describe. To change a hierarchy while other threads
// query it, lock it in the program, for example by POSIX:
//
//   pthread_rwlock_rdlock(&lock);  /* a query */
//   hs_bvh_query(bvh, &queries, NULL, ids, room, NULL, &total);
//   pthread_rwlock_unlock(&lock);
//
//   pthread_rwlock_wrlock(&lock);  /* a change, after all queries returned */
//   hs_bvh_set(bvh, moved_ids, &moved_boxes);
//   pthread_rwlock_unlock(&lock);
//
// The C++ headers describe each operation in more detail: fit_many.h, reject.h,
// reject_many.h, quantized.h, bvh.h, bvh_nearest.h, bvh_pairs.h and
// broad_phase.h.
#ifndef HALFSPACE_C_HALFSPACE_H_
#define HALFSPACE_C_HALFSPACE_H_

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "halfspace/export.h"
#include "halfspace/version.h"

// An enum can have any value of an int: functions check it.
#ifdef __cplusplus
#define HALFSPACE_INT : int
extern "C" {
#else
#define HALFSPACE_INT
#endif

// Status, version, targets ----------------------------------------------------

// C++ programs: if halfspace::SetErrorHandler (error.h) has set a handler, the
// library calls it for the errors that it finds below this interface. If the
// handler throws, the call returns a status as for any exception. If a callback
// or an allocator throws, the call ends and returns HS_INTERNAL, or
// HS_OUT_OF_MEMORY for std::bad_alloc.
typedef enum hs_status HALFSPACE_INT {
  HS_OK = 0,
  HS_INVALID_ARGUMENT = 1,  // an argument violates what the function requires
  HS_OUT_OF_MEMORY = 2,     // an allocation failed
  HS_IO_ERROR = 3,          // a file cannot be read or written; except on
                            // Windows, errno says why
  HS_CORRUPT = 4,           // a file or bytes contain no BVH or broad phase,
                            // were altered, or have another kind of bounds
  HS_UNSUPPORTED = 5,       // not available on this system
  HS_INTERNAL = 6           // an exception of a callback, or an error of the
                            // library
} hs_status;

// Returns the version of the library, for example "0.1.0".
// HALFSPACE_VERSION_STRING (version.h) is the version of the header.
HALFSPACE_API const char* hs_version(void);

// Returns the message of the last call of this thread that failed: which
// function and argument, what was expected and what was given. Returns "" if no
// call failed. The text is valid until another call of this thread fails. Calls
// that succeed do not change it.
HALFSPACE_API const char* hs_last_error(void);

// The parts of that message, for programs that have their own names for
// functions and arguments, such as bindings to other languages. The argument is
// written as in "ids[7]" or "options->margin", and is "" if the message is
// about no argument alone. The reason is the rest, as in "expected the id of an
// object, got 7". The message is "FUNCTION: ARGUMENT: REASON", without
// "ARGUMENT: " if that is "". The texts are valid as long as the message is.
HALFSPACE_API const char* hs_last_error_argument(void);
HALFSPACE_API const char* hs_last_error_reason(void);

// Returns the name of a status, for example "HS_OK", or "unknown status".
HALFSPACE_API const char* hs_status_name(hs_status status);

// The targets (instruction sets) that this machine supports, best first. The
// name of target i, or null if `i` is not below the count. Names are static.
HALFSPACE_API size_t hs_target_count(void);
HALFSPACE_API const char* hs_target_name(size_t i);

// Writes the name of the target of calls that name none: the best one, or the
// value of the environment variable HALFSPACE_TARGET. Fails if that value is
// not the name of a supported target. Calls that need a target and name none
// fail then, too.
HALFSPACE_API hs_status hs_chosen_target(const char** name);

// Configurations --------------------------------------------------------------
//
// Configurations and options begin with `struct_size`. Fill them by their
// function hs_..._default(), then change fields. `struct_size` must be the size
// of the struct of a version of this header. The size lets a program that
// was compiled with an older header use a newer library: fields that the
// program does not know have their defaults. If the program's struct is larger
// than the library's, the additional bytes must be 0. `options` may be null:
// all fields then have their defaults.

// Memory ----------------------------------------------------------------------

// The functions that an object allocates its memory with. Set both, or neither
// for the default, operator new. The struct is copied. What `context` points to
// must outlive the object. The functions can be called by several threads at
// the same time if the program uses objects with the same functions in several
// threads, or if `run` does. Strings for the path of a file, and what the C++
// runtime needs while a call fails, do not come from these functions.
typedef struct hs_allocator {
  // Returns memory that is aligned to `alignment`, which is 64, or null.
  void* (*allocate)(void* context, size_t bytes, size_t alignment);
  // `bytes` and `alignment` are those of the allocation.
  void (*deallocate)(void* context, void* block, size_t bytes,
                     size_t alignment);
  void* context;
} hs_allocator;

// Arrays of records -----------------------------------------------------------

typedef enum hs_scalar HALFSPACE_INT {
  HS_FLOAT32 = 0,
  HS_FLOAT64 = 1
} hs_scalar;

enum { HS_MAX_COLUMNS = 9 };

// The type of all input arrays of bounds, shapes and queries. Value v of record
// i is element i * stride of column[v], which has the type `type`. So this can
// be an array of structs, a structure of arrays, or columns of a database. A
// function reads as many columns as it says and ignores the others. With a
// stride of 0, all records are the same. Columns are not copied, unless the
// function says so, and are not needed after the call.
typedef struct hs_columns {
  hs_scalar type;
  size_t count;   // records
  size_t stride;  // scalars from one record to the next
  const void* column[HS_MAX_COLUMNS];
} hs_columns;

// Returns the columns of `count` records of `values` consecutive scalars each.
static inline hs_columns hs_float_rows(const float* data, size_t count,
                                       size_t values) {
  hs_columns columns;
  size_t v;
  columns.type = HS_FLOAT32;
  columns.count = count;
  columns.stride = values;
  for (v = 0; v < HS_MAX_COLUMNS; ++v) {
    columns.column[v] = data != NULL && v < values ? data + v : NULL;
  }
  return columns;
}
static inline hs_columns hs_double_rows(const double* data, size_t count,
                                        size_t values) {
  hs_columns columns;
  size_t v;
  columns.type = HS_FLOAT64;
  columns.count = count;
  columns.stride = values;
  for (v = 0; v < HS_MAX_COLUMNS; ++v) {
    columns.column[v] = data != NULL && v < values ? data + v : NULL;
  }
  return columns;
}

// Bounds ----------------------------------------------------------------------

// The kind of bounds of an object. Bounds are records of floats or doubles, all
// minima and then all maxima, in any unit.
//
// The octahedron (a k-DOP) has one more axis than the box, D = -(x + y + z): a
// box with two opposite corners cut off. Make its records by hs_bound_...(),
// which round D outward.
//
// An object of a simplex kind stores the minima of the octahedron alone, and
// its query is the maxima. Its records are those of octahedra: the minima of a
// query and the maxima of an object are not read, and these columns may be
// null.
//
// NaN and special values: a NaN in a plane never separates, so an object with
// NaNs alone is found by every query. {INFINITY, ..., -INFINITY, ...}, all
// minima and then all maxima, is the empty bound: no finite query finds it. An
// object with a minimum above a maximum is tested as it is.
typedef enum hs_kind HALFSPACE_INT {
  HS_BOX2 = 1,         // min x y, max x y
  HS_BOX3 = 2,         // min x y z, max x y z
  HS_OCTAHEDRON2 = 3,  // min x y D, max x y D
  HS_OCTAHEDRON3 = 4,  // min x y z D, max x y z D
  HS_SIMPLEX2 = 5,     // as HS_OCTAHEDRON2
  HS_SIMPLEX3 = 6      // as HS_OCTAHEDRON3
} hs_kind;

// Returns the number of values of a record: 4, 6, 6, 8, 6 or 8. Returns 0 if
// `kind` is none of the enumerators.
HALFSPACE_API size_t hs_bound_values(hs_kind kind);

typedef struct hs_bound_options {
  size_t struct_size;
  int empty_if_inverted;  // 1: a box with a minimum above a maximum becomes the
                          // empty bound. 0: it is a mistake
  const char* target;     // null: the chosen target
} hs_bound_options;

HALFSPACE_API hs_status hs_bound_options_default(hs_bound_options* options,
                                                 size_t struct_size);

// Write the bounds of shapes in 2 or 3 dimensions, d, as `kind` has them. The
// record of shape i is bounds[i * values] ... bounds[i * values + values - 1],
// where `values` is hs_bound_values(kind).
//
// The bounds enclose the exact shapes, rounding included. A shape that cannot
// be bounded becomes everything: minima of -FLT_MAX and maxima of FLT_MAX,
// which every finite query finds. These are shapes with a NaN, an infinity, a
// negative radius, a vertex that does not exist, magnitudes that sum to more
// than 2^125, and, by default, inverted boxes. `everything` receives their
// number and may be null. A box of {INFINITY, ..., -INFINITY, ...} or {FLT_MAX,
// ..., -FLT_MAX, ...} becomes the empty bound and is not counted. For doubles,
// DBL_MAX replaces FLT_MAX.
//
// Cost: with AVX-512, octahedra in 3 dimensions take 5 ns per shape of floats,
// 11 ns per triangle of floats, and 60 to 90 ns per shape of doubles.
//
// Boxes: 2 d columns, the minima and the maxima.
HALFSPACE_API hs_status hs_bound_boxes(hs_kind kind, const hs_columns* boxes,
                                       const hs_bound_options* options,
                                       float* bounds, size_t* everything);
// Spheres: d + 1 columns, the center and the radius.
HALFSPACE_API hs_status hs_bound_spheres(hs_kind kind,
                                         const hs_columns* spheres,
                                         const hs_bound_options* options,
                                         float* bounds, size_t* everything);
// Points: d columns. Each point has a bound of its own.
HALFSPACE_API hs_status hs_bound_points(hs_kind kind, const hs_columns* points,
                                        const hs_bound_options* options,
                                        float* bounds, size_t* everything);
// The convex hulls of `sets` ranges of points: set i has the points ends[i - 1]
// ... ends[i] - 1, and set 0 begins at point 0. A set without points becomes
// the empty bound. A set that ends before it begins or after the last point
// becomes everything. The coordinates of a point must be adjacent in memory, or
// the stride must be 1. Otherwise the status is HS_UNSUPPORTED.
HALFSPACE_API hs_status hs_bound_point_sets(hs_kind kind,
                                            const hs_columns* points,
                                            const size_t* ends, size_t sets,
                                            const hs_bound_options* options,
                                            float* bounds, size_t* everything);
// Triangles: 3 d columns, the coordinates of the three corners one after
// another.
HALFSPACE_API hs_status hs_bound_triangles(hs_kind kind,
                                           const hs_columns* triangles,
                                           const hs_bound_options* options,
                                           float* bounds, size_t* everything);
// The `faces` triangles of a mesh. Its vertices have d columns, and triangle i
// has the vertices indices[3 * i], indices[3 * i + 1] and indices[3 * i + 2].
HALFSPACE_API hs_status hs_bound_faces(hs_kind kind, const hs_columns* vertices,
                                       const uint32_t* indices, size_t faces,
                                       const hs_bound_options* options,
                                       float* bounds, size_t* everything);

// Flat scans ------------------------------------------------------------------

// The index and the id of no object.
#define HS_NO_ID UINT32_C(0xFFFFFFFF)

// A copy of bounds. A query tests every object in SIMD. For one query over a
// thousand objects or more, a BVH is faster.
typedef struct hs_scan hs_scan;

typedef struct hs_scan_config {
  size_t struct_size;
  hs_kind kind;  // must be set
  int bits;      // 0: floats. 8 or 16: floats and quantized values, which are
                 // tested first. The results are the same.
  hs_allocator allocator;
} hs_scan_config;

HALFSPACE_API hs_status hs_scan_config_default(hs_scan_config* config,
                                               size_t struct_size);

// Copies the bounds. The index of an object is that of its record.
HALFSPACE_API hs_status hs_scan_create(const hs_scan_config* config,
                                       const hs_columns* objects,
                                       hs_scan** scan);
// `scan` may be null.
HALFSPACE_API void hs_scan_destroy(hs_scan* scan);
HALFSPACE_API hs_status hs_scan_size(const hs_scan* scan, size_t* size);

typedef struct hs_scan_options {
  size_t struct_size;
  size_t begin;  // tests the objects begin ... end - 1 alone. `end` may be
  size_t end;    // beyond the last object; by default it is SIZE_MAX
  size_t skip;   // results that are not written, in hs_scan_indices() and
                 // hs_scan_pairs()
  const char* target;  // null: the chosen target
} hs_scan_options;

HALFSPACE_API hs_status hs_scan_options_default(hs_scan_options* options,
                                                size_t struct_size);

// The number of words in a mask of so many objects.
static inline size_t hs_mask_words(size_t objects) {
  return objects / 64 + (objects % 64 != 0 ? 1 : 0);
}

// Writes a mask per query, one after another. Object `begin` + i is bit i % 64
// of word i / 64. A bit is 1 if the object survives, and 0 behind the last
// object. `words` is the size of `masks`, and must be at least queries->count *
// hs_mask_words(n) for n objects in the range.
HALFSPACE_API hs_status hs_scan_masks(const hs_scan* scan,
                                      const hs_columns* queries,
                                      const hs_scan_options* options,
                                      uint64_t* masks, size_t words);

// Writes the indices of the survivors, query after query, ascending in each.
//   indices  has room for `room` indices
//   offsets  may be null, or has queries->count + 1 elements: the indices of
//            query q are results offsets[q] ... offsets[q + 1] - 1, also if
//            `room` is too small
//   total    receives the number of all results
HALFSPACE_API hs_status hs_scan_indices(const hs_scan* scan,
                                        const hs_columns* queries,
                                        const hs_scan_options* options,
                                        uint32_t* indices, size_t room,
                                        size_t* offsets, size_t* total);

// Writes the number of survivors of each query.
HALFSPACE_API hs_status hs_scan_counts(const hs_scan* scan,
                                       const hs_columns* queries,
                                       const hs_scan_options* options,
                                       size_t* counts);

// Writes the index of one survivor of each query, or HS_NO_ID if there is none.
HALFSPACE_API hs_status hs_scan_any(const hs_scan* scan,
                                    const hs_columns* queries,
                                    const hs_scan_options* options,
                                    uint32_t* indices);

// Writes the pairs of a query and an object that survives it. Result i is query
// query_indices[i] and object object_indices[i]. Both arrays have room for
// `room` elements. The order is not that of the queries. For many queries this
// is faster than hs_scan_indices(), because a part of the objects is tested
// against up to 256 queries while it is in the cache.
HALFSPACE_API hs_status hs_scan_pairs(const hs_scan* scan,
                                      const hs_columns* queries,
                                      const hs_scan_options* options,
                                      uint32_t* query_indices,
                                      uint32_t* object_indices, size_t room,
                                      size_t* total);

// The hierarchy: create, change -----------------------------------------------

// A BVH with 64 children per node, over a copy of the bounds of up to 2^31 - 1
// objects. An object has an id: the index of its record, or what
// hs_bvh_insert() wrote.
typedef struct hs_bvh hs_bvh;

// Build quality. It changes the cost of queries, never their results.
typedef enum hs_quality HALFSPACE_INT {
  HS_QUALITY_HIGH = 0,  // about as long as the bulk load of an R-tree
  HS_QUALITY_FAST = 1   // about a third of the time. Queries take up to 1.4
                        // times as long, and longer in uneven worlds: see
                        // BuildQuality in bvh.h.
} hs_quality;

// Runs the parts of a build on threads of the caller: calls part(work, i)
// `count` times, in any order and on any threads, and returns when all these
// calls have returned. `i` is the number of the call, 0 ... count - 1. Each
// call runs the next part, whatever `i` is. With another number of calls the
// build fails.
typedef void (*hs_part_function)(void* work, size_t i);
typedef void (*hs_run_function)(void* context, size_t count,
                                hs_part_function part, void* work);

typedef struct hs_bvh_config {
  size_t struct_size;
  hs_kind kind;  // must be set
  hs_quality quality;
  const char* target;   // null: the chosen target
  hs_run_function run;  // null: the calling thread does all work
  void* run_context;
  hs_allocator allocator;
  const float* query_extents;  // null: queries are about as large as the
                               // objects. Or d numbers that are not negative:
                               // the extents of a typical query. INFINITY where
                               // queries do not limit an axis.
                               // BuildOptions::query_extents (bvh.h) says when
                               // to give them. Read by hs_bvh_create(),
                               // hs_bvh_rebuild() and hs_builder_create().
} hs_bvh_config;

HALFSPACE_API hs_status hs_bvh_config_default(hs_bvh_config* config,
                                              size_t struct_size);

// Builds a BVH. The columns are read in place, also doubles and columns with a
// stride. O(n log n).
HALFSPACE_API hs_status hs_bvh_create(const hs_bvh_config* config,
                                      const hs_columns* objects, hs_bvh** bvh);
// `bvh` may be null.
HALFSPACE_API void hs_bvh_destroy(hs_bvh* bvh);

// Collects objects in batches. hs_builder_push() appends a copy of the records,
// as floats, and fails if there are then more than 2^31 - 1 objects. Ids are in
// the order of the pushes. hs_builder_finish() builds a BVH of all objects that
// were pushed. The builder is unchanged then, and can be continued or
// destroyed. `builder` of hs_builder_destroy() may be null.
typedef struct hs_builder hs_builder;
HALFSPACE_API hs_status hs_builder_create(const hs_bvh_config* config,
                                          hs_builder** builder);
// Creates a builder for more objects than fit into memory. hs_builder_push()
// writes the records to a temporary file in the folder of `path`.
// hs_builder_finish() sorts them in runs of `memory` bytes (24 and the planes
// of each object), or of 256 MiB if it is 0, writes the BVH to `path` as
// hs_bvh_save() does, and maps it as hs_bvh_map() does. Beyond `memory` it uses
// pages of mapped files, which the system can evict. During hs_builder_finish()
// the files take up to 5 times the bytes of the objects' planes as floats. The
// BVH takes up to 1.9 times these bytes.
//
// If all objects fit into one run, the BVH has the quality of the
// configuration. Otherwise it has HS_QUALITY_FAST. If a file cannot be written,
// a call returns HS_IO_ERROR, names the argument `path`, and leaves the builder
// as it was. O(n log n).
HALFSPACE_API hs_status hs_builder_create_file(const hs_bvh_config* config,
                                               const char* path, size_t memory,
                                               hs_builder** builder);
HALFSPACE_API hs_status hs_builder_push(hs_builder* builder,
                                        const hs_columns* objects);
HALFSPACE_API hs_status hs_builder_finish(const hs_builder* builder,
                                          hs_bvh** bvh);
HALFSPACE_API void hs_builder_destroy(hs_builder* builder);

// Writes the number of objects.
HALFSPACE_API hs_status hs_bvh_size(const hs_bvh* bvh, size_t* size);
// Writes one more than the greatest id in use since the last hs_bvh_rebuild():
// the size that an array by id needs. hs_bvh_rebuild() can reduce it, if the
// objects with the greatest ids were erased. It is 0 after the last object was
// erased: ids then begin at 0 again.
HALFSPACE_API hs_status hs_bvh_id_limit(const hs_bvh* bvh, size_t* limit);
// Writes the bound of all objects as one record. The maxima of a simplex are
// INFINITY.
HALFSPACE_API hs_status hs_bvh_bounds(const hs_bvh* bvh, float* record);
// Writes the bounds of the objects `ids`, one record after another. O(n) per
// object before the first change by id, and O(1) after it.
HALFSPACE_API hs_status hs_bvh_get(const hs_bvh* bvh, const uint32_t* ids,
                                   size_t count, float* records);
// Writes the bounds of all objects by id: record i is that of object i, or the
// empty bound if there is none. `records` has room for `room` records, which
// must be at least hs_bvh_id_limit(). Records beyond it are not written. O(n).
HALFSPACE_API hs_status hs_bvh_get_all(const hs_bvh* bvh, float* records,
                                       size_t room);
// Writes the bytes of memory that the BVH uses, and of its blob.
HALFSPACE_API hs_status hs_bvh_bytes(const hs_bvh* bvh, size_t* bytes);

// Adds objects and writes their ids: those of erased objects, or the next ones.
// `ids` must have objects->count elements.
HALFSPACE_API hs_status hs_bvh_insert(hs_bvh* bvh, const hs_columns* objects,
                                      uint32_t* ids);

// Adds objects under ids that the caller chooses: record i is that of object
// ids[i]. `ids` must have objects->count elements. No object may have such an
// id, and it must be in `ids` once. The BVH takes 4.13 bytes for each id below
// the greatest.
HALFSPACE_API hs_status hs_bvh_insert_as(hs_bvh* bvh, const uint32_t* ids,
                                         const hs_columns* objects);

// Allocates the memory of so many objects at once.
HALFSPACE_API hs_status hs_bvh_reserve(hs_bvh* bvh, size_t objects);

// Sets the bounds of objects: record i is that of object ids[i]. `ids` has
// objects->count elements. If an id is given twice, the last record counts.
HALFSPACE_API hs_status hs_bvh_set(hs_bvh* bvh, const uint32_t* ids,
                                   const hs_columns* objects);

// Removes objects. An id that is given twice is removed once.
HALFSPACE_API hs_status hs_bvh_erase(hs_bvh* bvh, const uint32_t* ids,
                                     size_t count);

// Sets the masks of `count` objects: masks[i] is that of object ids[i]. If an
// id is given twice, the last mask counts. An object whose mask was never set
// has all bits. An object whose mask is 0 is found only by a query whose mask
// is all ones.
HALFSPACE_API hs_status hs_bvh_set_masks(hs_bvh* bvh, const uint32_t* ids,
                                         const uint32_t* masks, size_t count);

// Sets the masks of all objects: masks[i] is that of object i. Masks of erased
// objects are not read. `count` must be at least hs_bvh_id_limit().
HALFSPACE_API hs_status hs_bvh_set_all_masks(hs_bvh* bvh, const uint32_t* masks,
                                             size_t count);

// Gives all objects new bounds by id: record i is that of object i. Records of
// erased objects are not read. objects->count must be at least
// hs_bvh_id_limit(). The tree keeps its order, so it becomes slower as objects
// move: see hs_bvh_cost_ratio(). `run` may be null: the calling thread then
// does all work. If `run` fails, refit again before the next query.
HALFSPACE_API hs_status hs_bvh_refit(hs_bvh* bvh, const hs_columns* objects,
                                     hs_run_function run, void* run_context);

// Sorts all objects again and frees memory that is not needed. Ids stay.
// `config` may be null; its `quality`, `target`, `run`, `run_context` and
// `query_extents` are read. If these are null, those of an earlier call stay.
HALFSPACE_API hs_status hs_bvh_rebuild(hs_bvh* bvh,
                                       const hs_bvh_config* config);

// How much the order has decayed: 1 as sorted, 2 if queries visit up to twice
// as many leaves. INFINITY if more than 64 objects were never sorted.
// O(n / 64).
HALFSPACE_API hs_status hs_bvh_cost_ratio(const hs_bvh* bvh, double* ratio);

// How many leaves of 64 objects a query reads on average, if it has these d
// extents, INFINITY where it does not limit an axis, and can be anywhere within
// hs_bvh_bounds(). Many leaves: give hs_bvh_config::query_extents. Not of
// simplices. O(n / 64).
HALFSPACE_API hs_status hs_bvh_expected_leaves(const hs_bvh* bvh,
                                               const float* extents,
                                               double* leaves);

// The hierarchy: queries ------------------------------------------------------
//
// Broad phases have the same functions (hs_broad_phase_query() and so on), with
// the same arguments and results. Where a comment names an object, it also
// means a body.

// The type of the queries of ..._query(), ..._count(), ..._any() and
// ..._query_each(). Those that are no bounds must be floats.
// bvh_shapes.h says which objects survive them.
typedef enum hs_shape HALFSPACE_INT {
  HS_SHAPE_BOUND = 0,        // a record of the kind of the objects
  HS_SHAPE_POINT = 1,        // d columns
  HS_SHAPE_SPHERE = 2,       // d + 1 columns: the center and the radius
  HS_SHAPE_ROUNDED_BOX = 3,  // 2 d + 1 columns: the minima, the maxima and the
                             // distance from this box
  HS_SHAPE_HALF_SPACES = 4   // d + 1 columns: the normal and the offset. All
                             // rows together, at most 64, are one query: the
                             // region in front of all of them
} hs_shape;

// Writes the half-spaces of a camera, for one query of HS_SHAPE_HALF_SPACES or
// for c/kernels.h: 12 rows of 4 floats. `matrix` has 16 floats. frustum.h says
// what the arguments mean, and that there are no points of the frustum behind
// the half-spaces.
//
//   float seen[12 * 4];
//   hs_frustum_planes(matrix, HS_CLIP_ZERO_TO_ONE, HS_COLUMN_MAJOR, seen);
//   hs_columns query = hs_float_rows(seen, 12, 4);
typedef enum hs_clip_depth HALFSPACE_INT {
  HS_CLIP_MINUS_ONE_TO_ONE = 0,  // OpenGL
  HS_CLIP_ZERO_TO_ONE = 1        // Direct3D, Vulkan, Metal, WebGPU
} hs_clip_depth;
typedef enum hs_matrix_order HALFSPACE_INT {
  HS_COLUMN_MAJOR = 0,  // also a matrix for row vectors that is stored by rows
  HS_ROW_MAJOR = 1
} hs_matrix_order;
HALFSPACE_API hs_status hs_frustum_planes(const float* matrix,
                                          hs_clip_depth depth,
                                          hs_matrix_order order,
                                          float* half_spaces);

typedef struct hs_query_options {
  size_t struct_size;
  uint32_t mask;   // finds the objects whose mask has one of these bits; by
                   // default all ones, which finds all objects. 0 finds none.
                   // The mask of a body is its category.
  hs_shape shape;  // by default HS_SHAPE_BOUND
  size_t skip;     // results that are not written, in ..._query() alone
  const char* target;  // null: the chosen target
  int exclusive;       // 1: leaves out each object whose box is equal to the
                       // query. Only ..._nearest_...() read it. The bounds
                       // must be boxes.
} hs_query_options;

HALFSPACE_API hs_status hs_query_options_default(hs_query_options* options,
                                                 size_t struct_size);

// What a callback returns. HS_STOP, or any other value, ends the call, which
// then returns HS_OK. The callback must not change the BVH.
typedef enum hs_visit HALFSPACE_INT { HS_CONTINUE = 0, HS_STOP = 1 } hs_visit;

// Writes the ids of the survivors, query after query, in no particular order in
// each. `ids`, `room`, `offsets` and `total` as in hs_scan_indices(). `offsets`
// count all results, also those that `skip` leaves out: result r is in
// ids[r - skip] if skip <= r < skip + room. Many queries of a large tree are
// faster in the order of a curve (SurvivorsOfEach() in bvh.h).
HALFSPACE_API hs_status hs_bvh_query(const hs_bvh* bvh,
                                     const hs_columns* queries,
                                     const hs_query_options* options,
                                     uint32_t* ids, size_t room,
                                     size_t* offsets, size_t* total);

// Writes the number of survivors of each query.
HALFSPACE_API hs_status hs_bvh_count(const hs_bvh* bvh,
                                     const hs_columns* queries,
                                     const hs_query_options* options,
                                     size_t* counts);

// Writes one survivor of each query, or HS_NO_ID if there is none.
HALFSPACE_API hs_status hs_bvh_any(const hs_bvh* bvh, const hs_columns* queries,
                                   const hs_query_options* options,
                                   uint32_t* ids);

// Calls the function with 1 to 4096 survivors of one query at a time, query
// after query. Queries with few results are answered 64 at a time before the
// function is called for them. So pass many queries at once.
typedef hs_visit (*hs_ids_function)(void* context, size_t query,
                                    const uint32_t* ids, size_t count);
HALFSPACE_API hs_status hs_bvh_query_each(const hs_bvh* bvh,
                                          const hs_columns* queries,
                                          const hs_query_options* options,
                                          hs_ids_function function,
                                          void* context);

// Writes the `k` objects nearest to each point (d columns) or box (2 d columns)
// that are within `max_distance`, which may be INFINITY, in ascending order.
// Row i is elements i * k ... i * k + k - 1 of `ids` and `distances`. If there
// are fewer than k, the rest of the row is HS_NO_ID and INFINITY. `distances`
// may be null.
//
// Distances are those of the boxes of the bounds, not of the objects in them,
// within 2^-20 (relative). 0 if the two touch. A point of doubles is the
// smallest box of floats that contains it. A box {INFINITY, ..., -INFINITY,
// ...} is empty and finds nothing. Another box with a minimum above its maximum
// is HS_INVALID_ARGUMENT. The axis of a coordinate that is a NaN limits
// nothing.
HALFSPACE_API hs_status hs_bvh_nearest_to_points(
    const hs_bvh* bvh, const hs_columns* points, size_t k, float max_distance,
    const hs_query_options* options, uint32_t* ids, float* distances);
HALFSPACE_API hs_status hs_bvh_nearest_to_boxes(
    const hs_bvh* bvh, const hs_columns* boxes, size_t k, float max_distance,
    const hs_query_options* options, uint32_t* ids, float* distances);

// Casts of rays, boxes and spheres.
//
// Rays have 2 d + 1 columns of floats: the origin, the direction, which may
// have any length, and the limit of t. t is from 0 to the limit, in multiples
// of the direction, and the limit may be INFINITY. `radius` makes the rays
// thick: bounds grow by it on each side.
//
// Boxes have 2 d columns, and spheres, the center and the radius, d + 1 columns
// of floats. `motions` are as many records with d + 1 columns of floats: the
// direction and the limit of t. Doubles are HS_INVALID_ARGUMENT, except boxes,
// because a direction cannot be rounded outward.
//
// Writes the object whose bound each ray enters first, or each box or sphere
// touches first, and where; HS_NO_ID and INFINITY if there is none. Of objects
// with the same t, the one with the least id. `ts` may be null.
HALFSPACE_API hs_status hs_bvh_raycast(const hs_bvh* bvh,
                                       const hs_columns* rays, float radius,
                                       const hs_query_options* options,
                                       uint32_t* ids, float* ts);
HALFSPACE_API hs_status hs_bvh_boxcast(const hs_bvh* bvh,
                                       const hs_columns* boxes,
                                       const hs_columns* motions,
                                       const hs_query_options* options,
                                       uint32_t* ids, float* ts);
HALFSPACE_API hs_status hs_bvh_spherecast(const hs_bvh* bvh,
                                          const hs_columns* spheres,
                                          const hs_columns* motions,
                                          const hs_query_options* options,
                                          uint32_t* ids, float* ts);

// Calls the function for the objects that a cast finds, cast after cast, and in
// each about from near to far, but not sorted. The function returns the new
// limit of t: objects beyond it are not found. A greater limit than the last
// one changes nothing, and neither does a NaN. A negative limit ends the cast.
// For the closest hit of the objects themselves, return the least t of an exact
// hit so far.
typedef float (*hs_hit_function)(void* context, size_t cast, uint32_t id,
                                 float t);
HALFSPACE_API hs_status hs_bvh_raycast_each(
    const hs_bvh* bvh, const hs_columns* rays, float radius,
    const hs_query_options* options, hs_hit_function function, void* context);
HALFSPACE_API hs_status hs_bvh_boxcast_each(
    const hs_bvh* bvh, const hs_columns* boxes, const hs_columns* motions,
    const hs_query_options* options, hs_hit_function function, void* context);
HALFSPACE_API hs_status hs_bvh_spherecast_each(
    const hs_bvh* bvh, const hs_columns* spheres, const hs_columns* motions,
    const hs_query_options* options, hs_hit_function function, void* context);

// The ids of two objects. In a join, `a` is of the first BVH.
typedef struct hs_id_pair {
  uint32_t a;
  uint32_t b;
} hs_id_pair;

typedef struct hs_pair_options {
  size_t struct_size;
  uint32_t mask;  // the masks of both objects must have one of these bits
  float margin;   // also finds pairs that are at most this far apart on each
                  // axis. Must be finite and not negative.
  size_t skip;    // pairs that are not written and not given to a function
  size_t begin;   // finds the pairs of the parts begin ... end - 1 alone
  size_t end;     // (hs_bvh_pair_parts()); by default it is SIZE_MAX
  const char* target;      // null: the chosen target
  const uint32_t* wanted;  // in ..._pairs_of() alone: null, or a mask for each
                           // id. Object ids[i] wants the objects whose mask has
                           // one bit of wanted[i], and with all ones it wants
                           // all. A pair is found if an object of the set wants
                           // the other one.
  float within;  // also finds pairs of boxes whose Euclidean distance is at
                 // most this. Must be finite and not negative, and 0 if there
                 // is a margin.
} hs_pair_options;

HALFSPACE_API hs_status hs_pair_options_default(hs_pair_options* options,
                                                size_t struct_size);

// All overlapping pairs of objects of a BVH, each once, and those of an object
// of `a` and one of `b`, which must be of the same kind. BVHs are of boxes or
// octahedra. Simplices of one kind have no planes that face each other:
// HS_INVALID_ARGUMENT.
//
// `pairs` has room for `room` pairs, and `total` receives the number of all.
HALFSPACE_API hs_status hs_bvh_pairs(const hs_bvh* bvh,
                                     const hs_pair_options* options,
                                     hs_id_pair* pairs, size_t room,
                                     size_t* total);
HALFSPACE_API hs_status hs_bvh_join(const hs_bvh* a, const hs_bvh* b,
                                    const hs_pair_options* options,
                                    hs_id_pair* pairs, size_t room,
                                    size_t* total);

// As hs_bvh_pairs() and hs_bvh_join(), but they call the function with 1 to 256
// pairs at a time.
typedef hs_visit (*hs_pairs_function)(void* context, const hs_id_pair* pairs,
                                      size_t count);
HALFSPACE_API hs_status hs_bvh_pairs_each(const hs_bvh* bvh,
                                          const hs_pair_options* options,
                                          hs_pairs_function function,
                                          void* context);
HALFSPACE_API hs_status hs_bvh_join_each(const hs_bvh* a, const hs_bvh* b,
                                         const hs_pair_options* options,
                                         hs_pairs_function function,
                                         void* context);

// The pairs of an object of a set, which is `a`, and any other object of the
// BVH. A pair of two objects of the set is found once. If `wanted` of only one
// of them finds the pair, this one is `a`, and otherwise `a` is the earlier one
// in the order of the tree. A caller that needs the order of its own list swaps
// the two if `b` is earlier there. The cost grows with the set. Can allocate
// memory during the call.
HALFSPACE_API hs_status hs_bvh_pairs_of(const hs_bvh* bvh, const uint32_t* ids,
                                        size_t count,
                                        const hs_pair_options* options,
                                        hs_id_pair* pairs, size_t room,
                                        size_t* total);
HALFSPACE_API hs_status hs_bvh_pairs_of_each(const hs_bvh* bvh,
                                             const uint32_t* ids, size_t count,
                                             const hs_pair_options* options,
                                             hs_pairs_function function,
                                             void* context);

// Writes the number of parts of hs_bvh_pairs(bvh), and of hs_bvh_join(bvh, b)
// for any b. Each pair belongs to one part, so threads can share the work. The
// parts take unequal times: use more ranges than threads.
HALFSPACE_API hs_status hs_bvh_pair_parts(const hs_bvh* bvh, size_t* parts);

// The hierarchy: pairs that begin and end -------------------------------------

// The pairs of a BVH at the last update, and the difference to the update
// before. pair_events.h describes it. An engine that moves its bodies, then
// updates, then queries, needs no more than this and a BVH. A broad phase has
// pair events of its own: hs_broad_phase_update_pairs().
//
//   hs_pair_events* events = NULL;
//   hs_pair_events_create(NULL, &events);
//   // each frame:
//   hs_bvh_set(bvh, moved_ids, &moved_boxes);
//   hs_pair_events_update_of(events, bvh, moved_ids, moved_count, NULL);
//   hs_pair_events_began(events, &pairs, &count);
//   hs_pair_events_ended(events, &pairs, &count);
typedef struct hs_pair_events hs_pair_events;

typedef struct hs_pair_event_options {
  size_t struct_size;
  uint32_t mask;  // both are as in hs_pair_options
  float margin;
  const char* target;   // null: the chosen target
  hs_run_function run;  // null: the calling thread does all work. The pairs do
                        // not depend on it.
  void* run_context;
} hs_pair_event_options;

HALFSPACE_API hs_status hs_pair_event_options_default(
    hs_pair_event_options* options, size_t struct_size);

// `allocator` may be null: the default, operator new. Pairs take 8 to 12 bytes
// each, and twice as much during an update.
HALFSPACE_API hs_status hs_pair_events_create(const hs_allocator* allocator,
                                              hs_pair_events** events);
// `events` may be null.
HALFSPACE_API void hs_pair_events_destroy(hs_pair_events* events);

// Finds all pairs of the BVH, which is of boxes or octahedra. A call that fails
// changes nothing.
HALFSPACE_API hs_status
hs_pair_events_update(hs_pair_events* events, const hs_bvh* bvh,
                      const hs_pair_event_options* options);

// Finds the pairs of the `count` objects `changed`, and keeps the pairs of the
// others. `changed` must have the ids of all objects that were inserted,
// changed or erased since the last update, once or more often. The pairs of an
// erased object end. If `changed` has a quarter as many ids as the BVH has
// objects, it finds all pairs. Otherwise a new mask or margin counts for the
// pairs of `changed` alone.
HALFSPACE_API hs_status hs_pair_events_update_of(
    hs_pair_events* events, const hs_bvh* bvh, const uint32_t* changed,
    size_t count, const hs_pair_event_options* options);

// Returns all pairs of the last update, in any order, with a < b. The array of
// each of these three functions is valid until the next update or load.
HALFSPACE_API hs_status hs_pair_events_pairs(const hs_pair_events* events,
                                             const hs_id_pair** pairs,
                                             size_t* count);
// Returns the pairs that the update before had not. They are sorted by a, then
// by b.
HALFSPACE_API hs_status hs_pair_events_began(const hs_pair_events* events,
                                             const hs_id_pair** pairs,
                                             size_t* count);
// Returns the pairs that only the update before had, in the same order.
HALFSPACE_API hs_status hs_pair_events_ended(const hs_pair_events* events,
                                             const hs_id_pair** pairs,
                                             size_t* count);

// Sets the pairs, in any order, and removes all events: the next update
// returns the differences to these. Store the pairs with a blob, and load both,
// to go on as the stored ones would. Without pairs, it frees all memory. Each
// pair must have a < b < 4294967295, and must be in the list once.
HALFSPACE_API hs_status hs_pair_events_load(hs_pair_events* events,
                                            const hs_id_pair* pairs,
                                            size_t count);

// The hierarchy: bytes and files ----------------------------------------------

// The BVH as bytes, valid until it changes or is destroyed. The bytes can be
// null and 0 if the BVH has no objects: hs_bvh_from_blob() accepts these, too,
// and returns a BVH without objects. O(n) for the first call after a change,
// then O(1). The bytes depend on the machine's byte order and have a version of
// their own.
HALFSPACE_API hs_status hs_bvh_blob(const hs_bvh* bvh, const void** data,
                                    size_t* size);

// Writes the kind of the bounds in a blob, or fails with HS_CORRUPT if the
// bytes do not begin as a blob. The other calls check the rest of its header.
// O(1).
HALFSPACE_API hs_status hs_blob_kind(const void* data, size_t size,
                                     hs_kind* kind);

// Creates a BVH of a copy of these bytes. Of `config`, the kind and the
// allocator are read. The kind must be that of the blob. Checks the bytes by
// their checksum, which finds damage, but no attack. Bytes that were altered
// with a new checksum can give wrong results, and never an access outside the
// BVH. O(n).
HALFSPACE_API hs_status hs_bvh_from_blob(const hs_bvh_config* config,
                                         const void* data, size_t size,
                                         hs_bvh** bvh);

// Creates a BVH that refers to these bytes, or to a copy of them if they are
// not aligned to 64 bytes. What hs_bvh_map() says of the file is true of the
// bytes: only their header is checked, and they must not change while the BVH
// lives.
HALFSPACE_API hs_status hs_bvh_in_place(const hs_bvh_config* config,
                                        const void* data, size_t size,
                                        hs_bvh** bvh);

// A path is UTF-8 on Windows, and the system's bytes elsewhere.
//
// Writes the blob to a file. An existing file is replaced when the new one is
// complete: the blob is first written to a new file in the same folder. The
// name of this file is `path` and 13 more characters that end with ".tmp". It
// is removed if the call fails. The file has the permissions of a new file,
// also if it replaces a file with others. A symbolic link at `path` is
// replaced, not the file that it names.
//
// If `path` exists, it must be a file or a link to one. HS_IO_ERROR for
// anything else, such as a folder, a device or a FIFO.
HALFSPACE_API hs_status hs_bvh_save(const hs_bvh* bvh, const char* path);

// Reads a file of hs_bvh_save(), as hs_bvh_from_blob() does. The file must not
// be made shorter during the call: the process can end by SIGBUS. hs_bvh_save()
// to the same path is fine, as it replaces the file.
HALFSPACE_API hs_status hs_bvh_load(const hs_bvh_config* config,
                                    const char* path, hs_bvh** bvh);

// Maps such a file. The BVH can be used at once, and pages are read when a
// query needs them. Only the header is checked: see hs_bvh_verify(). Altered
// bytes can give wrong results, and never an access outside the BVH.
//
// The file must not be changed or made shorter while the BVH lives. The checks
// are then void, and calls can crash. hs_bvh_save() to the same path is fine,
// as it replaces the file. But Windows refuses to replace a file while it is
// mapped: hs_bvh_save() returns HS_IO_ERROR until the BVH is destroyed.
//
// The first change of the BVH copies the bytes and checks them in part: it can
// fail with HS_INVALID_ARGUMENT if they were altered.
HALFSPACE_API hs_status hs_bvh_map(const hs_bvh_config* config,
                                   const char* path, hs_bvh** bvh);

// Returns HS_CORRUPT if the BVH was mapped or refers to bytes, has not changed
// since, and its bytes do not match their checksum. O(n).
HALFSPACE_API hs_status hs_bvh_verify(const hs_bvh* bvh);

// Triangle meshes -------------------------------------------------------------

// Triangles that do not move (mesh.h). Whether a ray hits a triangle is decided
// exactly, so no ray passes between triangles that share an edge. A ray through
// the edge hits both, so the parity of hits does not say whether a point is
// inside of a closed mesh. A triangle with a NaN or an infinity is never found.
typedef struct hs_mesh hs_mesh;

// Builds a mesh of `faces` triangles, and copies their corners. Vertices are 3
// columns of floats. Triangle i has the vertices indices[3 * i],
// indices[3 * i + 1] and indices[3 * i + 2]. If `indices` is null, it has the
// vertices 3 * i, 3 * i + 1 and 3 * i + 2. `allocator` may be null. Doubles are
// HS_INVALID_ARGUMENT. O(n log n).
HALFSPACE_API hs_status hs_mesh_create(const hs_columns* vertices,
                                       const uint32_t* indices, size_t faces,
                                       const hs_allocator* allocator,
                                       hs_mesh** mesh);
// `mesh` may be null.
HALFSPACE_API void hs_mesh_destroy(hs_mesh* mesh);

// Writes the triangle that each ray hits first, from either side, and where: of
// those with the least t, the one with the least index. HS_NO_ID and INFINITY
// if there is none. Rays are as in hs_bvh_raycast(). `target` is the name of a
// target, or null for the chosen one. `ts` may be null.
HALFSPACE_API hs_status hs_mesh_raycast(const hs_mesh* mesh,
                                        const hs_columns* rays,
                                        const char* target, uint32_t* ids,
                                        float* ts);
// Writes 1 for each ray that hits a triangle, and 0 for the others.
HALFSPACE_API hs_status hs_mesh_occluded(const hs_mesh* mesh,
                                         const hs_columns* rays,
                                         const char* target, uint8_t* is_hit);
// Calls the function for each triangle that a ray hits, as
// hs_bvh_raycast_each() calls it for boxes.
HALFSPACE_API hs_status hs_mesh_raycast_each(const hs_mesh* mesh,
                                             const hs_columns* rays,
                                             const char* target,
                                             hs_hit_function function,
                                             void* context);

// Writes the triangle that is closest to each point within `max_distance`,
// which may be INFINITY; HS_NO_ID and INFINITY if there is none. Of those at
// the same distance, the one with the least index. Points are 3 columns of
// floats. `closest` receives 3 coordinates for each point, on the triangle.
// `closest` and `distances` may be null.
HALFSPACE_API hs_status hs_mesh_closest_points(
    const hs_mesh* mesh, const hs_columns* points, float max_distance,
    const char* target, uint32_t* ids, float* closest, float* distances);

// The broad phase -------------------------------------------------------------

// The moving bodies of a simulation, found by queries, casts and pairs while
// other threads move them. Ids are the caller's numbers below 2^31, such as the
// index of a body. A query finds the bodies that it would find in an hs_bvh of
// their bounds.
//
//   hs_broad_phase_config config;
//   hs_broad_phase_config_default(&config, sizeof config);
//   config.kind = HS_BOX3;
//   hs_broad_phase* bodies = NULL;
//   hs_broad_phase_create(&config, &bodies);
//   hs_broad_phase_insert(bodies, ids, &boxes, NULL);
//   /* each frame: */
//   hs_broad_phase_move(bodies, moved_ids, &moved_boxes);
//   hs_broad_phase_update(bodies, NULL);
//   hs_broad_phase_update_pairs(bodies, NULL);
//   hs_broad_phase_began(bodies, &pairs, &count);
//
// Thread safety:
// - Queries, nearest, casts, hs_broad_phase_pairs_of(), ..._move(), ..._has(),
//   ..._get(), ..._bounds(), ..._size() and ..._id_limit() can run at any time,
//   also at the same time as the functions below. Two calls that change the
//   same body must not run at the same time.
// - hs_broad_phase_insert(), ..._erase(), ..._set_masks(), ..._update(),
//   ..._rebuild(), ..._update_pairs(), ..._load(), ..._save(), ..._copy(),
//   ..._statistics() and ..._validate() run one after another. Bodies may move
//   at the same time. Each waits until no query runs, except in its callback.
//   Queries that begin wait for it, but not during the search of
//   ..._update_pairs(), nor while ..._save() or ..._copy() writes. After such a
//   call and a query have waited for each other, the next 64 updates, searches
//   for pairs, saves and copies go on beside queries (broad_phase.h).
// - A query never waits for a query, and ..._move() waits for nothing. No call
//   waits for a callback, so each may be made under any lock.
// - hs_broad_phase_destroy() needs exclusive access, and nobody may read the
//   pairs of the last update while ..._update_pairs() or ..._load() runs.
//
// A callback of a query can take locks and make any other call except
// ..._destroy(). It must return on the thread that called the query. If the
// bodies change while it runs, the query begins again after it. Each body that
// is there all the time is reported once.
typedef struct hs_broad_phase hs_broad_phase;

// A query with mask m finds a body if `category & m` is not 0, and with all
// ones it finds every body. Two bodies are a pair of ..._update_pairs() if the
// category of each has a bit of the other's `collides_with`. A body that was
// inserted without masks has all ones in both.
typedef struct hs_body_masks {
  uint32_t category;
  uint32_t collides_with;
} hs_body_masks;

// The caller's rule for the pairs of ..._update_pairs(): returns whether two
// bodies that overlap are a pair. `masks_match` is the rule of hs_body_masks.
// The function must return the same for (a, b) and (b, a), and the same in each
// call until hs_broad_phase_set_masks() of one of them. It can run on several
// threads at the same time, and must not call functions of the broad phase.
typedef bool (*hs_keep_function)(void* context, uint32_t a, uint32_t b,
                                 bool masks_match);

typedef struct hs_broad_phase_config {
  size_t struct_size;
  hs_kind kind;                // must be set: boxes or octahedra
  int moves_are_seen_at_once;  // 0: queries see moves from the next
                               // ..._update(), ..._update_pairs(),
                               // ..._rebuild(), ..._save() or ..._copy() on.
                               // 1: a query sees each move that returned before
                               // it began. It is slower while other threads
                               // move bodies.
  int caller_locks;            // 1: has no lock, which saves about 6 ns of each
                               // query. No two calls may run at the same time,
                               // except moves, and queries after ..._update()
                               // before the next move.
  hs_keep_function keep;       // null: the masks alone
  void* keep_context;
  hs_allocator allocator;  // also called by queries that allocate, and by the
                           // threads of `run`
} hs_broad_phase_config;

HALFSPACE_API hs_status hs_broad_phase_config_default(
    hs_broad_phase_config* config, size_t struct_size);

HALFSPACE_API hs_status hs_broad_phase_create(
    const hs_broad_phase_config* config, hs_broad_phase** bodies);
// `bodies` may be null.
HALFSPACE_API void hs_broad_phase_destroy(hs_broad_phase* bodies);
// Creates a copy, with the same bodies, masks, pairs, configuration and
// allocator. From then on, it gives the same results in the same order after
// the same calls.
HALFSPACE_API hs_status hs_broad_phase_copy(const hs_broad_phase* bodies,
                                            hs_broad_phase** copy);

// In the functions below, `ids` has bounds->count elements, or `count`. If an
// id is wrong, the call changes nothing. Bounds that are rows of floats are
// read in place. Others are copied, with memory of the allocator.

// Adds bodies: record i is the bound of body ids[i]. `masks` is null, or has an
// element for each id. Insert many bodies by one call: they are sorted
// together. The memory grows with the greatest id.
HALFSPACE_API hs_status hs_broad_phase_insert(hs_broad_phase* bodies,
                                              const uint32_t* ids,
                                              const hs_columns* bounds,
                                              const hs_body_masks* masks);

// Removes bodies. An id that is given twice is removed once. Until the next
// ..._update_pairs(), a new body under the id of an erased one continues its
// pairs.
HALFSPACE_API hs_status hs_broad_phase_erase(hs_broad_phase* bodies,
                                             const uint32_t* ids, size_t count);

// Changes the bounds of bodies. If an id is given twice, the last record
// counts. Takes no lock and waits for nothing.
HALFSPACE_API hs_status hs_broad_phase_move(hs_broad_phase* bodies,
                                            const uint32_t* ids,
                                            const hs_columns* bounds);

// Changes the masks of bodies. The next ..._update_pairs() looks at all their
// pairs.
HALFSPACE_API hs_status hs_broad_phase_set_masks(hs_broad_phase* bodies,
                                                 const uint32_t* ids,
                                                 const hs_body_masks* masks,
                                                 size_t count);

typedef struct hs_update_options {
  size_t struct_size;
  size_t budget;  // hs_broad_phase_update() alone: if the order has decayed,
                  // sorts about so many bodies again. 0 sorts none. SIZE_MAX,
                  // the default, is a 16th of all, or all if bodies are so
                  // fast that parts do not keep up.
  hs_run_function run;  // null: the calling thread does all work
  void* run_context;
} hs_update_options;

HALFSPACE_API hs_status hs_update_options_default(hs_update_options* options,
                                                  size_t struct_size);

// Call it once per frame. Copies the bounds that moved into the tree, and sorts
// bodies again where the order has decayed. Changes no result.
HALFSPACE_API hs_status hs_broad_phase_update(hs_broad_phase* bodies,
                                              const hs_update_options* options);

// The same, and sorts all bodies again.
HALFSPACE_API hs_status hs_broad_phase_rebuild(
    hs_broad_phase* bodies, const hs_update_options* options);

// Finds all pairs of bodies that overlap and that the masks and `keep` keep.
// Does not need ..._update() before it. `options->run` can run parts of the
// work. The pairs do not depend on it. If it fails, the call has changed
// nothing.
HALFSPACE_API hs_status hs_broad_phase_update_pairs(
    hs_broad_phase* bodies, const hs_update_options* options);

// All pairs of the last ..._update_pairs(), in any order; those that were not
// there after the ..._update_pairs() before; and those that were and are not
// now. a < b, and the last two lists are sorted by a, then by b. The pairs of
// erased bodies end. Valid until the next ..._update_pairs() or ..._load().
HALFSPACE_API hs_status hs_broad_phase_pairs(const hs_broad_phase* bodies,
                                             const hs_id_pair** pairs,
                                             size_t* count);
HALFSPACE_API hs_status hs_broad_phase_began(const hs_broad_phase* bodies,
                                             const hs_id_pair** pairs,
                                             size_t* count);
HALFSPACE_API hs_status hs_broad_phase_ended(const hs_broad_phase* bodies,
                                             const hs_id_pair** pairs,
                                             size_t* count);

// Writes the number of bodies.
HALFSPACE_API hs_status hs_broad_phase_size(const hs_broad_phase* bodies,
                                            size_t* size);
// Writes the size that an array by id needs.
HALFSPACE_API hs_status hs_broad_phase_id_limit(const hs_broad_phase* bodies,
                                                size_t* limit);
// Writes 1 if a body has this id, which may be any number, and else 0.
HALFSPACE_API hs_status hs_broad_phase_has(const hs_broad_phase* bodies,
                                           uint32_t id, int* has);
// Writes the bounds of bodies, one record after another, and their masks.
// `records` and `masks` may be null.
HALFSPACE_API hs_status hs_broad_phase_get(const hs_broad_phase* bodies,
                                           const uint32_t* ids, size_t count,
                                           float* records,
                                           hs_body_masks* masks);
// Writes the bound of all bodies as one record.
HALFSPACE_API hs_status hs_broad_phase_bounds(const hs_broad_phase* bodies,
                                              float* record);

typedef struct hs_body_statistics {
  size_t struct_size;
  size_t bodies;
  size_t pairs;       // of the last hs_broad_phase_update_pairs()
  size_t bytes;       // all memory
  double cost_ratio;  // as hs_bvh_cost_ratio()
} hs_body_statistics;

// `struct_size` is the size of the struct.
HALFSPACE_API hs_status
hs_broad_phase_statistics(const hs_broad_phase* bodies,
                          hs_body_statistics* statistics, size_t struct_size);

// Writes 1 if the tree has each body once, with its bound, and else 0. For
// tests and bug reports. Must not run at the same time as ..._move(). O(n).
HALFSPACE_API hs_status hs_broad_phase_validate(const hs_broad_phase* bodies,
                                                int* is_valid);

// Writes all bodies, masks and pairs as bytes, at most `room`, and the number
// of all to `size`. If `room` is too small, call it again with more.
HALFSPACE_API hs_status hs_broad_phase_save(const hs_broad_phase* bodies,
                                            void* data, size_t room,
                                            size_t* size);

// Replaces the bodies, masks and pairs by saved ones. The configuration stays.
// From then on, results and pairs are those that the saved broad phase would
// have given, in the same order. HS_CORRUPT if the bytes are not those of
// ..._save() of this kind of bounds and byte order, or were cut. Other
// alterations can give wrong results, and never an access outside the bytes.
HALFSPACE_API hs_status hs_broad_phase_load(hs_broad_phase* bodies,
                                            const void* data, size_t size);

// The searches are those of hierarchies, and each comment stands there. They
// find each body by a bound that it had during the call. Differences:
// - If more results are found than there is `room`, a second call can find
//   other ones, as bodies can have moved.
// - ..._nearest_...(), ..._pairs_of(), ..._pairs_of_each() and ..._bounds()
//   copy the tree if moves are seen at once, bodies have moved since the last
//   ..._update(), and another query runs: ..._nearest_...() once for each
//   record. Queries with callbacks keep a list of what they have reported,
//   which takes memory from 2048 bodies on.
// - ..._pairs_of() does not read `collides_with`, and does not call `keep`.
//
HALFSPACE_API hs_status hs_broad_phase_query(const hs_broad_phase* bodies,
                                             const hs_columns* queries,
                                             const hs_query_options* options,
                                             uint32_t* ids, size_t room,
                                             size_t* offsets, size_t* total);
HALFSPACE_API hs_status hs_broad_phase_count(const hs_broad_phase* bodies,
                                             const hs_columns* queries,
                                             const hs_query_options* options,
                                             size_t* counts);
HALFSPACE_API hs_status hs_broad_phase_any(const hs_broad_phase* bodies,
                                           const hs_columns* queries,
                                           const hs_query_options* options,
                                           uint32_t* ids);
HALFSPACE_API hs_status hs_broad_phase_query_each(
    const hs_broad_phase* bodies, const hs_columns* queries,
    const hs_query_options* options, hs_ids_function function, void* context);
HALFSPACE_API hs_status hs_broad_phase_nearest_to_points(
    const hs_broad_phase* bodies, const hs_columns* points, size_t k,
    float max_distance, const hs_query_options* options, uint32_t* ids,
    float* distances);
HALFSPACE_API hs_status hs_broad_phase_nearest_to_boxes(
    const hs_broad_phase* bodies, const hs_columns* boxes, size_t k,
    float max_distance, const hs_query_options* options, uint32_t* ids,
    float* distances);
HALFSPACE_API hs_status hs_broad_phase_raycast(const hs_broad_phase* bodies,
                                               const hs_columns* rays,
                                               float radius,
                                               const hs_query_options* options,
                                               uint32_t* ids, float* ts);
HALFSPACE_API hs_status hs_broad_phase_boxcast(const hs_broad_phase* bodies,
                                               const hs_columns* boxes,
                                               const hs_columns* motions,
                                               const hs_query_options* options,
                                               uint32_t* ids, float* ts);
HALFSPACE_API hs_status hs_broad_phase_spherecast(
    const hs_broad_phase* bodies, const hs_columns* spheres,
    const hs_columns* motions, const hs_query_options* options, uint32_t* ids,
    float* ts);
HALFSPACE_API hs_status hs_broad_phase_raycast_each(
    const hs_broad_phase* bodies, const hs_columns* rays, float radius,
    const hs_query_options* options, hs_hit_function function, void* context);
HALFSPACE_API hs_status hs_broad_phase_boxcast_each(
    const hs_broad_phase* bodies, const hs_columns* boxes,
    const hs_columns* motions, const hs_query_options* options,
    hs_hit_function function, void* context);
HALFSPACE_API hs_status hs_broad_phase_spherecast_each(
    const hs_broad_phase* bodies, const hs_columns* spheres,
    const hs_columns* motions, const hs_query_options* options,
    hs_hit_function function, void* context);
HALFSPACE_API hs_status hs_broad_phase_pairs_of(const hs_broad_phase* bodies,
                                                const uint32_t* ids,
                                                size_t count,
                                                const hs_pair_options* options,
                                                hs_id_pair* pairs, size_t room,
                                                size_t* total);
HALFSPACE_API hs_status hs_broad_phase_pairs_of_each(
    const hs_broad_phase* bodies, const uint32_t* ids, size_t count,
    const hs_pair_options* options, hs_pairs_function function, void* context);

#undef HALFSPACE_INT
#ifdef __cplusplus
}
#endif

#endif  // HALFSPACE_C_HALFSPACE_H_
