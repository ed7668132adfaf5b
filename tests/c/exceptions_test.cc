// The C API in a program that has C++ as well: exceptions of callbacks, and an
// error handler. No exception leaves a call.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <new>
#include <stdexcept>
#include <string>

#include "halfspace/error.h"

extern "C" {
#include "check.h"
}

namespace {

thread_local std::size_t news_left = SIZE_MAX;

}  // namespace

// All in this program, up to a number. A DLL has its own.
void* operator new(std::size_t bytes) {
  void* const block = news_left == 0 ? nullptr : std::malloc(bytes);
  if (block == nullptr) throw std::bad_alloc();
  if (news_left != SIZE_MAX) --news_left;
  return block;
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace {

std::string told;

void* ThrowAnother(void*, size_t, size_t) { throw 7; }
void Free(void*, void* block, size_t, size_t) { std::free(block); }

hs_visit ThrowAtIds(void*, size_t, const uint32_t*, size_t) {
  throw std::runtime_error("a callback's own error");
}
float ThrowAtHit(void*, size_t, uint32_t, float) { throw std::bad_alloc(); }
hs_visit ThrowAtPairs(void*, const hs_id_pair*, size_t) { throw 7; }

// Whatever allocation fails, no new file stays.
void TestSaveWithoutMemory(const hs_bvh* bvh) {
  const std::filesystem::path folder = "c_test_exceptions";
  const std::string path = (folder / "a_name_that_is_allocated").string();
  const auto count_files = [&] {
    const std::filesystem::directory_iterator files(folder);
    return std::distance(begin(files), end(files));
  };
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  std::size_t news = 0;
  for (;; ++news) {
    news_left = news;
    const hs_status status = hs_bvh_save(bvh, path.c_str());
    news_left = SIZE_MAX;
    if (status == HS_OK) break;
    CHECK(status == HS_OUT_OF_MEMORY && count_files() == 0);
  }
#if !defined(_WIN32) || !defined(HALFSPACE_SHARED)
  CHECK(news > 0);
#endif
  CHECK(count_files() == 1);
  std::filesystem::remove_all(folder);
}

}  // namespace

extern "C" void test_exceptions(void) {
  const float boxes[] = {0, 0, 1, 1, 0, 0, 1, 1};
  const float ray[] = {0, 0, 1, 0, 1};
  hs_bvh_config config = bvh_config_of(HS_BOX2);
  const hs_columns columns = hs_float_rows(boxes, 2, 4);
  const hs_columns rays = hs_float_rows(ray, 1, 5);
  hs_bvh* bvh = nullptr;
  CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
  CHECK_FAILS(
      hs_bvh_query_each(bvh, &columns, nullptr, &ThrowAtIds, nullptr),
      HS_INTERNAL,
      "hs_bvh_query_each: an exception ended the call: a callback's own error");
  CHECK_FAILS(hs_bvh_raycast_each(bvh, &rays, 0, nullptr, &ThrowAtHit, nullptr),
              HS_OUT_OF_MEMORY, "hs_bvh_raycast_each: an allocation failed");
  CHECK_FAILS(hs_bvh_pairs_each(bvh, nullptr, &ThrowAtPairs, nullptr),
              HS_INTERNAL,
              "hs_bvh_pairs_each: an exception of a callback, an allocator or "
              "an error handler ended the call");

  // A handler is told what the C++ library finds.
  halfspace::SetErrorHandler([](const halfspace::Error& error) {
    told = error.what();
    throw error;
  });
  hs_bvh* none = nullptr;
  CHECK_FAILS(hs_bvh_from_blob(&config, boxes, sizeof(boxes), &none),
              HS_CORRUPT,
              "hs_bvh_from_blob: data: expected a header of 64 bytes, got 32");
  CHECK(told.find("halfspace: Bvh::FromBlob: blob: expected") == 0);
  halfspace::SetErrorHandler([](const halfspace::Error&) {
    throw std::invalid_argument("from the handler");
  });
  CHECK_FAILS(
      hs_bvh_from_blob(&config, boxes, sizeof(boxes), &none), HS_INTERNAL,
      "hs_bvh_from_blob: an exception ended the call: from the handler");
  halfspace::SetErrorHandler(nullptr);

  TestSaveWithoutMemory(bvh);

  config.allocator.allocate = &ThrowAnother;
  config.allocator.deallocate = &Free;
  CHECK(hs_bvh_create(&config, &columns, &none) == HS_INTERNAL);
  CHECK(none == nullptr);
  hs_bvh_destroy(bvh);
}
