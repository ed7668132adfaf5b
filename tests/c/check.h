// What the tests of the C API share: checks that go on after a failure, and
// random numbers.
#ifndef TESTS_C_CHECK_H_
#define TESTS_C_CHECK_H_

#include <halfspace/c/halfspace.h>
#include <stdio.h>
#include <string.h>

extern int failures;

#define CHECK(condition)                                              \
  do {                                                                \
    if (!(condition)) {                                               \
      ++failures;                                                     \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
    }                                                                 \
  } while (0)

// The status of the call is `status_` in the condition.
#define CHECK_STATUS(call, condition)                                   \
  do {                                                                  \
    const hs_status status_ = (call);                                   \
    if (!(condition)) {                                                 \
      ++failures;                                                       \
      fprintf(stderr, "%s:%d: %s: %s: %s\n", __FILE__, __LINE__, #call, \
              hs_status_name(status_), hs_last_error());                \
    }                                                                   \
  } while (0)
#define CHECK_OK(call) CHECK_STATUS(call, status_ == HS_OK)

// Whether the message of the last error is this text, and is made of its parts.
static inline int is_last_error(const char* text) {
  const char* const argument = hs_last_error_argument();
  char joined[1024];
  snprintf(joined, sizeof(joined), "%.*s: %s%s%s", (int)strcspn(text, ":"),
           text, argument, argument[0] != '\0' ? ": " : "",
           hs_last_error_reason());
  return strcmp(hs_last_error(), text) == 0 && strcmp(joined, text) == 0 &&
         strstr(hs_last_error_reason(), ": expected ") == NULL;
}

// The call fails with this status, and its message is this text.
#define CHECK_FAILS(call, expected, text) \
  CHECK_STATUS(call, status_ == (expected) && is_last_error(text))
#define CHECK_INVALID(call, text) CHECK_FAILS(call, HS_INVALID_ARGUMENT, text)
// The same, with the name of the function in front of the text.
#define INVALID(function, arguments, text) \
  CHECK_INVALID(function arguments, #function ": " text)
#define NOT_NULL(function, arguments, argument) \
  INVALID(function, arguments, argument ": expected a pointer, got null")

enum { KINDS = 6 };

static inline hs_kind kind_of(int i) { return (hs_kind)(i + 1); }
static inline int is_simplex(hs_kind kind) {
  return kind == HS_SIMPLEX2 || kind == HS_SIMPLEX3;
}
static inline size_t dims_of(hs_kind kind) {
  return kind == HS_BOX2 || kind == HS_OCTAHEDRON2 || kind == HS_SIMPLEX2 ? 2
                                                                          : 3;
}

// From 0 to 1.
static inline float random_float(uint32_t* state) {
  *state = *state * 1664525u + 1013904223u;
  return (float)(*state >> 8) / 16777216.0f;
}

// Writes the bounds of `count` random boxes.
void random_bounds(hs_kind kind, size_t count, float side, uint32_t seed,
                   float* bounds);

static inline hs_bvh_config bvh_config_of(hs_kind kind) {
  hs_bvh_config config;
  CHECK_OK(hs_bvh_config_default(&config, sizeof(config)));
  config.kind = kind;
  return config;
}
static inline hs_scan_config scan_config_of(hs_kind kind, int bits) {
  hs_scan_config config;
  CHECK_OK(hs_scan_config_default(&config, sizeof(config)));
  config.kind = kind;
  config.bits = bits;
  return config;
}

static inline hs_bvh* bvh_of(hs_kind kind, const hs_columns* objects) {
  const hs_bvh_config config = bvh_config_of(kind);
  hs_bvh* bvh = NULL;
  CHECK_OK(hs_bvh_create(&config, objects, &bvh));
  return bvh;
}

static inline int have_same_bytes(const hs_bvh* a, const hs_bvh* b) {
  const void* blobs[2] = {NULL, NULL};
  size_t sizes[2] = {0, 0};
  CHECK_OK(hs_bvh_blob(a, &blobs[0], &sizes[0]));
  CHECK_OK(hs_bvh_blob(b, &blobs[1], &sizes[1]));
  return sizes[0] == sizes[1] && memcmp(blobs[0], blobs[1], sizes[0]) == 0;
}

void test_callbacks(void);
void test_files(void);
void test_errors(void);
void test_memory(void);
void test_exceptions(void);  // in C++, as the next
void test_parity(void);

#endif  // TESTS_C_CHECK_H_
