// Hierarchies as bytes and files, also those that are none.
#define _POSIX_C_SOURCE 200809L  // lstat(), symlink()
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "check.h"

#if defined(__unix__) || defined(__APPLE__)
#include <dirent.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#define HAS_POSIX
#endif
#if defined(_WIN32)
#include <wchar.h>
static const hs_status kReplacesMapped = HS_IO_ERROR;
#else
static const hs_status kReplacesMapped = HS_OK;
#endif

enum { OBJECTS = 6000, VALUES = 6, MOST_VALUES = 8 };

static float objects[OBJECTS * MOST_VALUES];
static const char kPath[] = "c_test.bvh";
static hs_bvh_config box3;  // of boxes in 3 dimensions

// After a call that fails, nobody has the old handle.
static void destroy(hs_bvh** bvh) {
  hs_bvh_destroy(*bvh);
  *bvh = NULL;
}

static void write_file(const void* data, size_t size) {
  FILE* const file = fopen(kPath, "wb");
  CHECK(file != NULL);
  if (file == NULL) return;
  CHECK(fwrite(data, 1, size, file) == size);
  CHECK(fclose(file) == 0);
}

static size_t count_all(const hs_bvh* bvh) {
  const float everywhere[] = {-9, -9, -9, 9, 9, 9};
  const hs_columns asked = hs_float_rows(everywhere, 1, VALUES);
  size_t count = 0;
  CHECK_OK(hs_bvh_count(bvh, &asked, NULL, &count));
  return count;
}

// Of a BVH that a call has made.
static void check_count(hs_status status, hs_bvh** bvh, size_t count) {
  CHECK_OK(status);
  CHECK(count_all(*bvh) == count);
  destroy(bvh);
}

// The files that hs_bvh_save() has left. One could be of an earlier run.
static size_t count_remains(void) {
  size_t count = 0;
#if defined(HAS_POSIX)
  DIR* const folder = opendir(".");
  const struct dirent* entry;
  CHECK(folder != NULL);
  while (folder != NULL && (entry = readdir(folder)) != NULL) {
    count += strncmp(entry->d_name, "c_test", 6) == 0 &&
             strstr(entry->d_name, ".tmp") != NULL;
  }
  if (folder != NULL) closedir(folder);
#endif
  return count;
}

// The file has another kind, is cut, was altered, or is something else. No call
// makes a BVH of it.
static void check_refused(const hs_bvh_config* config, const char* text) {
  hs_bvh* bvh = NULL;
  CHECK(hs_bvh_load(config, kPath, &bvh) == HS_CORRUPT);
  CHECK(strstr(hs_last_error(), text) != NULL);
  CHECK(hs_bvh_map(config, kPath, &bvh) == HS_CORRUPT);
  CHECK(strstr(hs_last_error(), text) != NULL);
  CHECK(bvh == NULL);
}

static void test_kinds(void) {
  int i;
  for (i = 0; i < KINDS; ++i) {
    const hs_bvh_config config = bvh_config_of(kind_of(i));
    const hs_columns columns =
        hs_float_rows(objects, 9, hs_bound_values(config.kind));
    const void* blob = NULL;
    size_t size = 0;
    hs_bvh* bvh = NULL;
    hs_kind kind = (hs_kind)0;
    CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
    CHECK_OK(hs_bvh_blob(bvh, &blob, &size));
    CHECK_OK(hs_blob_kind(blob, size, &kind));
    CHECK(kind == config.kind);
    kind = (hs_kind)0;
    CHECK_FAILS(hs_blob_kind(blob, 63, &kind), HS_CORRUPT,
                "hs_blob_kind: data: expected the bytes of a stored BVH, got "
                "others");
    CHECK(hs_blob_kind(objects, sizeof(objects), &kind) == HS_CORRUPT);
    CHECK(kind == (hs_kind)0);
    NOT_NULL(hs_blob_kind, (NULL, size, &kind), "data");
    NOT_NULL(hs_blob_kind, (blob, size, NULL), "kind");
    destroy(&bvh);
  }
}

static void test_bad_files(const void* blob, size_t size) {
  const hs_bvh_config other = bvh_config_of(HS_OCTAHEDRON2);
  unsigned char* const altered = malloc(size);
  const size_t cuts[] = {1, 63, 64, 65, size / 2, size - 1};
  hs_bvh* bvh = NULL;
  size_t i;
  memcpy(altered, blob, size);
  write_file(blob, size);
  check_refused(&other, ": path: expected bounds of 2 dimensions, 3 axes");
  for (i = 0; i < sizeof(cuts) / sizeof(cuts[0]); ++i) {
    write_file(blob, cuts[i]);
    check_refused(&box3, ": path: expected ");
    CHECK(hs_bvh_from_blob(&box3, blob, cuts[i], &bvh) == HS_CORRUPT);
  }
  write_file("", 0);
  check_refused(&box3, "path: expected a stored BVH, got the empty file");
  CHECK_FAILS(hs_bvh_from_blob(&box3, "x", 1, &bvh), HS_CORRUPT,
              "hs_bvh_from_blob: data: expected a header of 64 bytes, got 1");
  write_file(
      "a text of more than 64 bytes, which is no hierarchy, but was "
      "given as one",
      72);
  check_refused(&box3,
                ": path: expected the bytes of a stored BVH, got another "
                "beginning");

  // One byte in the body: found by the checksum. A map has not read it yet.
  altered[size / 2] ^= 1;
  write_file(altered, size);
  CHECK(hs_bvh_from_blob(&box3, altered, size, &bvh) == HS_CORRUPT);
  CHECK_FAILS(hs_bvh_load(&box3, kPath, &bvh), HS_CORRUPT,
              "hs_bvh_load: expected the bytes that hs_bvh_blob() returned, "
              "got altered ones: store the BVH again");
  CHECK(bvh == NULL);
  CHECK_OK(hs_bvh_map(&box3, kPath, &bvh));
  (void)count_all(bvh);
  CHECK(hs_bvh_verify(bvh) == HS_CORRUPT);
  destroy(&bvh);
  free(altered);
}

static void test_whole_files(hs_bvh* bvh, const void* blob, size_t size) {
  hs_bvh* copy = NULL;
  const void* data = NULL;
  size_t bytes = 0;
  uint32_t id = 1;
  CHECK_OK(hs_bvh_save(bvh, kPath));
  CHECK_OK(hs_bvh_save(bvh, kPath));
  CHECK_OK(hs_bvh_load(&box3, kPath, &copy));
  CHECK(have_same_bytes(copy, bvh));
  CHECK_OK(hs_bvh_verify(copy));
  destroy(&copy);
  check_count(hs_bvh_from_blob(&box3, blob, size, &copy), &copy, OBJECTS);

  // In place, or a copy of bytes that are not aligned.
  {
    unsigned char* const bytes_behind = malloc(size + 64 + 1);
    unsigned char* const aligned =
        bytes_behind + (64 - (uintptr_t)bytes_behind % 64) % 64;
    size_t i;
    for (i = 0; i < 2; ++i) {
      memcpy(aligned + i, blob, size);
      CHECK_OK(hs_bvh_in_place(&box3, aligned + i, size, &copy));
      CHECK(count_all(copy) == OBJECTS);
      CHECK_OK(hs_bvh_blob(copy, &data, &bytes));
      CHECK(bytes == size && (data == aligned + i) == (i == 0));
      CHECK_OK(hs_bvh_bytes(copy, &bytes));
      CHECK(bytes == size);
      CHECK_OK(hs_bvh_verify(copy));
      CHECK_OK(hs_bvh_erase(copy, &id, 1));
      CHECK(count_all(copy) == OBJECTS - 1);
      CHECK(memcmp(aligned + i, blob, size) == 0);
      destroy(&copy);
    }
    aligned[size] ^= 1;
    CHECK_OK(hs_bvh_in_place(&box3, aligned + 1, size, &copy));
    CHECK(hs_bvh_verify(copy) == HS_CORRUPT);
    destroy(&copy);
    CHECK(hs_bvh_in_place(&box3, aligned + 1, size - 1, &copy) == HS_CORRUPT);
    free(bytes_behind);
  }

  // A map changes as any other, and the file does not.
  CHECK_OK(hs_bvh_map(&box3, kPath, &copy));
  CHECK(count_all(copy) == OBJECTS);
  CHECK_OK(hs_bvh_verify(copy));
  CHECK_OK(hs_bvh_erase(copy, &id, 1));
  CHECK(count_all(copy) == OBJECTS - 1);
  CHECK_OK(hs_bvh_verify(copy));
  destroy(&copy);
  check_count(hs_bvh_load(&box3, kPath, &copy), &copy, OBJECTS);
  // The file of a map can be replaced, except on Windows. There the old file
  // stays as it is.
  CHECK_OK(hs_bvh_map(&box3, kPath, &copy));
  CHECK(hs_bvh_save(copy, kPath) == kReplacesMapped);
  CHECK_OK(hs_bvh_erase(copy, &id, 1));
  CHECK(hs_bvh_save(copy, kPath) == kReplacesMapped);
  CHECK(count_all(copy) == OBJECTS - 1);
  destroy(&copy);
  check_count(hs_bvh_load(&box3, kPath, &copy), &copy,
              (kReplacesMapped == HS_OK ? OBJECTS - 1 : OBJECTS));
}

static void test_no_objects(void) {
  const hs_columns none = hs_float_rows(NULL, 0, 6);
  const hs_columns columns = hs_float_rows(objects, 2, 6);
  hs_bvh* bvh = NULL;
  hs_bvh* copy = NULL;
  uint32_t ids[2];
  const void* data = &bvh;
  size_t size = 1;
  CHECK_OK(hs_bvh_create(&box3, &none, &bvh));
  CHECK_OK(hs_bvh_blob(bvh, &data, &size));
  CHECK(data == NULL && size == 0);
  check_count(hs_bvh_from_blob(&box3, data, size, &copy), &copy, 0);
  CHECK_OK(hs_bvh_save(bvh, kPath));
  // A BVH with room has a header.
  CHECK_OK(hs_bvh_reserve(bvh, 1));
  CHECK_OK(hs_bvh_blob(bvh, &data, &size));
  CHECK(data != NULL && size >= 64);
  destroy(&bvh);
  CHECK_OK(hs_bvh_load(&box3, kPath, &bvh));
  CHECK(count_all(bvh) == 0);
  CHECK_OK(hs_bvh_insert(bvh, &columns, ids));
  CHECK(count_all(bvh) == 2 && ids[0] == 0 && ids[1] == 1);
  destroy(&bvh);
  check_count(hs_bvh_map(&box3, kPath, &bvh), &bvh, 0);
}

#if defined(HAS_POSIX)
static mode_t mode_of(const char* path) {
  struct stat status;
  return lstat(path, &status) == 0 ? status.st_mode : 0;
}
#endif

// UTF-8, with a letter outside of every code page of Windows.
static void test_spaces_and_umlauts(const hs_bvh* bvh) {
  static const char kName[] = "c_test \xc3\xa4 \xf0\x9f\x93\xa6.bvh";
  hs_bvh* copy = NULL;
  CHECK_OK(hs_bvh_save(bvh, kName));
  CHECK_OK(hs_bvh_save(bvh, kName));
  check_count(hs_bvh_load(&box3, kName, &copy), &copy, OBJECTS);
  check_count(hs_bvh_map(&box3, kName, &copy), &copy, OBJECTS);
#if defined(_WIN32)
  CHECK(_wremove(L"c_test \u00e4 \U0001f4e6.bvh") == 0);
#else
  CHECK(remove(kName) == 0);
#endif
}

static void test_paths(const hs_bvh* bvh) {
  hs_bvh* none = NULL;
  hs_builder* no_builder = NULL;
  CHECK(hs_builder_create_file(&box3, "c_test_none/file", 0, &no_builder) ==
        HS_IO_ERROR);
  CHECK(hs_builder_create_file(&box3, ".", 0, &no_builder) == HS_IO_ERROR);
  CHECK(hs_builder_create_file(&box3, "", 0, &no_builder) == HS_IO_ERROR);
  NOT_NULL(hs_builder_create_file, (NULL, "c_test", 0, &no_builder), "config");
  NOT_NULL(hs_builder_create_file, (&box3, NULL, 0, &no_builder), "path");
  NOT_NULL(hs_builder_create_file, (&box3, "c_test", 0, NULL), "builder");
  CHECK(no_builder == NULL);
  CHECK(hs_bvh_save(bvh, "c_test_none/file") == HS_IO_ERROR);
  CHECK(strstr(hs_last_error(), "hs_bvh_save: path: \"c_test_none/file.") ==
        hs_last_error());
  test_spaces_and_umlauts(bvh);
#if defined(_WIN32)
  // The text of the error is the system's.
  CHECK(hs_bvh_load(&box3, "c_test_none", &none) == HS_IO_ERROR);
  CHECK(strstr(hs_last_error(),
               "hs_bvh_load: path: \"c_test_none\" cannot be opened: ") ==
        hs_last_error());
  CHECK(strlen(strstr(hs_last_error(), "opened: ")) > 16);
  CHECK(hs_bvh_map(&box3, "c_test_none", &none) == HS_IO_ERROR);
  CHECK(hs_bvh_map(&box3, ".", &none) == HS_IO_ERROR);
  CHECK(hs_bvh_save(bvh, ".") == HS_IO_ERROR);
  CHECK(hs_bvh_save(bvh, "NUL") == HS_IO_ERROR);
  CHECK(hs_bvh_load(&box3, "NUL", &none) == HS_IO_ERROR);
  CHECK(hs_bvh_save(bvh, "c_test\xff") == HS_IO_ERROR);
  CHECK(strstr(hs_last_error(), " cannot be read as UTF-8: ") != NULL);
  CHECK(hs_bvh_map(&box3, "c_test\xff", &none) == HS_IO_ERROR);
#else
  CHECK_FAILS(hs_bvh_load(&box3, "c_test_none", &none), HS_IO_ERROR,
              "hs_bvh_load: path: \"c_test_none\" cannot be opened: No such "
              "file or directory");
  CHECK(errno == ENOENT);
  CHECK_FAILS(hs_bvh_map(&box3, "c_test_none", &none), HS_IO_ERROR,
              "hs_bvh_map: path: \"c_test_none\" cannot be opened: No such "
              "file or directory");
#endif
#if defined(HAS_POSIX)
  (void)mkdir("c_test_folder", 0700);
  CHECK_FAILS(hs_bvh_save(bvh, "c_test_folder"), HS_IO_ERROR,
              "hs_bvh_save: path: \"c_test_folder\" cannot be written: Is a "
              "directory");
  CHECK(hs_bvh_load(&box3, "c_test_folder", &none) == HS_IO_ERROR);
  CHECK(hs_bvh_map(&box3, "c_test_folder", &none) == HS_IO_ERROR);
  (void)remove("c_test_folder");
  // No call waits for the other end of a FIFO. A FIFO is not replaced, and
  // neither is a link to one. A link to a file is.
  CHECK(mkfifo("c_test_fifo", 0600) == 0);
  CHECK(symlink("c_test_fifo", "c_test_link") == 0);
  CHECK_FAILS(hs_bvh_save(bvh, "c_test_fifo"), HS_IO_ERROR,
              "hs_bvh_save: path: \"c_test_fifo\" cannot be written: No such "
              "device");
  CHECK_FAILS(hs_bvh_save(bvh, "c_test_link"), HS_IO_ERROR,
              "hs_bvh_save: path: \"c_test_link\" cannot be written: No such "
              "device");
  CHECK(S_ISFIFO(mode_of("c_test_fifo")) && S_ISLNK(mode_of("c_test_link")));
  (void)remove("c_test_link");
  CHECK(symlink(kPath, "c_test_link") == 0);
  CHECK_OK(hs_bvh_save(bvh, "c_test_link"));
  CHECK(S_ISREG(mode_of("c_test_link")));
  (void)remove("c_test_link");
  CHECK_FAILS(hs_bvh_load(&box3, "c_test_fifo", &none), HS_IO_ERROR,
              "hs_bvh_load: path: \"c_test_fifo\" cannot be read: No such "
              "device");
  CHECK_FAILS(hs_bvh_map(&box3, "c_test_fifo", &none), HS_IO_ERROR,
              "hs_bvh_map: path: \"c_test_fifo\" cannot be read: No such "
              "device");
  (void)remove("c_test_fifo");
  {
    // The longest name of a file that is common, and a shorter name of the new
    // file next to it.
    char name[256] = "c_test_";
    memset(name + 7, 'n', 235);
    CHECK_OK(hs_bvh_save(bvh, name));
    (void)remove(name);
  }
#endif
  CHECK(none == NULL);
}

// The objects of each kind in batches, in runs of one object, of some and of
// all. A builder goes on after hs_builder_finish().
static void test_builder_in_a_file(hs_kind kind) {
  static const size_t kMemory[] = {1, 40000, 0};
  static const size_t kBatches[] = {2500, 0, OBJECTS - 2500};
  const size_t values = hs_bound_values(kind);
  hs_bvh_config config = bvh_config_of(kind);
  hs_columns columns = hs_float_rows(objects, OBJECTS, values);
  size_t m;
  random_bounds(kind, OBJECTS, 0.01f, 12, objects);
  for (m = 0; m < sizeof(kMemory) / sizeof(kMemory[0]); ++m) {
    size_t size = 0;
    size_t b;
    size_t pushed = 0;
    hs_bvh* in_memory = NULL;
    hs_bvh* bvh = NULL;
    hs_builder* builder = NULL;
    config.quality = HS_QUALITY_HIGH;
    CHECK_OK(hs_builder_create_file(&config, kPath, kMemory[m], &builder));
    CHECK_OK(hs_builder_finish(builder, &bvh));
    CHECK_OK(hs_bvh_size(bvh, &size));
    CHECK(size == 0);
    destroy(&bvh);
    for (b = 0; b < 3; ++b) {
      columns = hs_float_rows(objects + pushed * values, kBatches[b], values);
      CHECK_OK(hs_builder_push(builder, &columns));
      pushed += kBatches[b];
    }
    CHECK_OK(hs_builder_finish(builder, &bvh));
    config.quality = kMemory[m] == 0 ? HS_QUALITY_HIGH : HS_QUALITY_FAST;
    columns = hs_float_rows(objects, OBJECTS, values);
    CHECK_OK(hs_bvh_create(&config, &columns, &in_memory));
    CHECK(have_same_bytes(bvh, in_memory));
    destroy(&bvh);
    destroy(&in_memory);
    columns = hs_float_rows(objects, 1, values);
    CHECK_OK(hs_builder_push(builder, &columns));
    CHECK_OK(hs_builder_finish(builder, &bvh));
    CHECK_OK(hs_bvh_size(bvh, &size));
    CHECK(size == OBJECTS + 1);
    destroy(&bvh);
    hs_builder_destroy(builder);
  }
}

#if defined(HAS_POSIX)
static void limit_files(rlim_t bytes) {
  struct rlimit limit;
  CHECK(getrlimit(RLIMIT_FSIZE, &limit) == 0);
  limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
  CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0);
}

// Neither a push nor hs_builder_finish() that fails changes the builder, or the
// file that is replaced.
static void test_builder_without_room(void) {
  const hs_columns columns = hs_float_rows(objects, OBJECTS, VALUES);
  const hs_columns few = hs_float_rows(objects, 100, VALUES);
  hs_bvh_config fast = box3;
  hs_builder* builder = NULL;
  hs_builder* in_memory = NULL;
  hs_bvh* bvh = NULL;
  hs_bvh* expected = NULL;
  void (*const before)(int) = signal(SIGXFSZ, SIG_IGN);
  CHECK_OK(hs_builder_create_file(&box3, kPath, 4096, &builder));
  CHECK_OK(hs_builder_push(builder, &few));
  CHECK_OK(hs_builder_finish(builder, &bvh));
  destroy(&bvh);
  limit_files(2500);
  CHECK(hs_builder_push(builder, &few) == HS_IO_ERROR);
  limit_files(50000);
  CHECK(hs_builder_push(builder, &columns) == HS_IO_ERROR);
  CHECK(strstr(hs_last_error(),
               "hs_builder_push: path: \"c_test.bvh\" cannot "
               "be written: ") == hs_last_error());
  limit_files(RLIM_INFINITY);
  CHECK_OK(hs_builder_push(builder, &columns));
  limit_files(150000);
  CHECK(hs_builder_finish(builder, &bvh) == HS_IO_ERROR && bvh == NULL);
  limit_files(RLIM_INFINITY);
  check_count(hs_bvh_load(&box3, kPath, &bvh), &bvh, 100);
  CHECK_OK(hs_builder_finish(builder, &bvh));
  fast.quality = HS_QUALITY_FAST;
  CHECK_OK(hs_builder_create(&fast, &in_memory));
  CHECK_OK(hs_builder_push(in_memory, &few));
  CHECK_OK(hs_builder_push(in_memory, &columns));
  CHECK_OK(hs_builder_finish(in_memory, &expected));
  CHECK(have_same_bytes(bvh, expected));
  destroy(&expected);
  destroy(&bvh);
  hs_builder_destroy(in_memory);
  hs_builder_destroy(builder);
  (void)signal(SIGXFSZ, before);
}

// A relative path is that of the folder at the time of the call.
static void test_builder_in_another_folder(void) {
  const hs_columns few = hs_float_rows(objects, 100, VALUES);
  hs_builder* builder = NULL;
  hs_bvh* bvh = NULL;
  CHECK(mkdir("c_test_folder", 0700) == 0);
  CHECK_OK(hs_builder_create_file(&box3, kPath, 64, &builder));
  CHECK_OK(hs_builder_push(builder, &few));
  CHECK(chdir("c_test_folder") == 0);
  check_count(hs_builder_finish(builder, &bvh), &bvh, 100);
  hs_builder_destroy(builder);
  CHECK(chdir("..") == 0);
  CHECK(rmdir("c_test_folder") == 0);
  check_count(hs_bvh_load(&box3, kPath, &bvh), &bvh, 100);
}

// A thread that has been canceled ends behind the calls, not in them. With
// AddressSanitizer its frames stay poisoned, so the preset asan sets
// use_sigaltstack=0: as the thread ends, the sanitizer would write into them.
static int has_returned = 0;
static void* use_files(void* bvh) {
  hs_bvh* copy = NULL;
  CHECK(pthread_cancel(pthread_self()) == 0);
  CHECK_OK(hs_bvh_save(bvh, kPath));
  CHECK_OK(hs_bvh_load(&box3, kPath, &copy));
  destroy(&copy);
  CHECK_OK(hs_bvh_map(&box3, kPath, &copy));
  destroy(&copy);
  has_returned = 1;
  pthread_testcancel();
  return NULL;
}
static void test_canceled(hs_bvh* bvh) {
  pthread_t thread;
  void* result = NULL;
  CHECK(pthread_create(&thread, NULL, use_files, bvh) == 0);
  CHECK(pthread_join(thread, &result) == 0);
  CHECK(has_returned && result == PTHREAD_CANCELED);
}
#endif

void test_files(void) {
  const hs_columns columns = hs_float_rows(objects, OBJECTS, VALUES);
  const size_t remains = count_remains();
  hs_bvh* bvh = NULL;
  const void* blob = NULL;
  size_t size = 0;
  int i;
  box3 = bvh_config_of(HS_BOX3);
  random_bounds(HS_BOX3, OBJECTS, 0.01f, 12, objects);
  CHECK_OK(hs_bvh_create(&box3, &columns, &bvh));
  CHECK_OK(hs_bvh_blob(bvh, &blob, &size));
  test_whole_files(bvh, blob, size);
  test_kinds();
  test_bad_files(blob, size);
  test_no_objects();
  test_paths(bvh);
#if defined(HAS_POSIX)
  test_canceled(bvh);
#endif
  destroy(&bvh);
  for (i = 0; i < KINDS; ++i) test_builder_in_a_file(kind_of(i));
#if defined(HAS_POSIX)
  random_bounds(HS_BOX3, OBJECTS, 0.01f, 12, objects);
  test_builder_without_room();
  test_builder_in_another_folder();
#endif
  (void)remove(kPath);
  CHECK(count_remains() == remains);
}
