// The calls of bvh_nearest.h: checks, and one search after another for what
// comes next.
#include "kernels/bvh/nearest.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// The key up to which objects are found that are within a distance, or not
// beyond a place on a line. It is finite, so that no infinite key is found. In
// the default floating-point mode a squared distance errs by less than 2^-21 of
// it and 3 * 2^-150 (docs/bvh.md).
float KeyLimit(bool is_line, float value) {
  const double limit = is_line
                           ? double{value} + kApartOnLine
                           : double{value} * value * (1 + 0x1p-20) + 0x1p-148;
  return static_cast<float>(std::min(limit, double{kMax<float>}));
}

void CheckLimit(const char* call, const char* argument, float value) {
  kernels::InDefaultFpMode([&] {
    if (value >= 0) return;
    kernels::ThrowInvalid(call, argument, "a number that is not negative",
                          std::to_string(value));
  });
}

// So many are found at once on the stack; at first for a function, and at most.
constexpr std::size_t kFirstRoom = 8;
constexpr std::size_t kMostRoom = 2048;

float KeyOf(KeyedSlot keyed) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(keyed >> 32));
}

const BvhNearestKernels& KernelsFor(const QueryOptions& options,
                                    const char* call) {
  return kBvhNearestKernels[dispatch::IndexOf(options.target, call)];
}

NearestSearch SearchFrom(const BvhTree& tree, std::size_t dims,
                         const float* point, float max_distance,
                         const QueryOptions& options) {
  NearestSearch search{};
  search.mask = options.mask;
  search.levels = &tree.levels();
  kernels::InDefaultFpMode([&] {
    MakeBall({dims, tree.shape().axes, tree.shape().has_max}, point, 0,
             search.ball);
    search.limit = KeyLimit(false, max_distance);
  });
  return search;
}

// Up to kMostRoom objects are found on the stack. More are found in the memory
// of the ids, where a keyed slot takes the place of two: each search finds half
// of the rest.
std::size_t WriteNearest(const BvhNearestKernels& kernels,
                         NearestSearch& search, Span<std::uint32_t> ids,
                         Span<float> distances, std::size_t most) {
  most = std::min(most, ids.size());
  KeyedSlot on_stack[kMostRoom];
  std::size_t total = 0;
  while (total < most) {
    std::uint32_t* const next_ids = ids.data() + total;
    search.found = on_stack;
    search.room = most - total;
    if (search.room > kMostRoom) {
      void* place = next_ids;
      std::size_t bytes = search.room * sizeof(*next_ids);
      std::align(alignof(KeyedSlot), 0, place, bytes);
      search.room = bytes / sizeof(KeyedSlot);
      search.found = new (place) KeyedSlot[search.room];
    }
    const std::size_t count = kernels.find(search);
    if (count > 0) search.from = search.found[count - 1] + 1;
    // An id is written over keyed slots that were read before.
    for (std::size_t i = 0; i < count; ++i) {
      const KeyedSlot keyed = search.found[i];
      next_ids[i] = search.levels->ids[static_cast<std::uint32_t>(keyed)];
      if (!distances.empty()) distances[total + i] = std::sqrt(KeyOf(keyed));
    }
    total += count;
    if (count < search.room) break;
  }
  return total;
}

// Calls the function until it ends the search.
void Call(const BvhNearestKernels& kernels, NearestSearch& search,
          NearFunction function, void* context) {
  const bool is_line = search.line != nullptr;
  KeyedSlot found[kMostRoom];
  search.found = found;
  for (search.room = kFirstRoom;;
       search.room = std::min(2 * search.room, kMostRoom)) {
    std::size_t i = 0;
    std::size_t count = 0;
    float value = 0;
    const auto has_next = [&] {
      if (i == count) return false;
      const float key = KeyOf(found[i]);
      value = is_line ? key : std::sqrt(key);
      return key <= search.limit;
    };
    bool goes_on = kernels::InDefaultFpMode([&] {
      count = kernels.find(search);
      return has_next();
    });
    while (goes_on) {
      const float limit = function(
          context, search.levels->ids[static_cast<std::uint32_t>(found[i])],
          value);
      goes_on = kernels::InDefaultFpMode([&] {
        if (limit < 0) return false;
        if (limit <= kMax<float>) {
          search.limit = std::min(search.limit, KeyLimit(is_line, limit));
        }
        ++i;
        return has_next();
      });
    }
    if (i < search.room) return;
    search.from = found[i - 1] + 1;
  }
}

}  // namespace

std::size_t BvhNearest(const BvhTree& tree, std::size_t dims,
                       const float* point, float max_distance,
                       Span<std::uint32_t> ids, Span<float> distances,
                       const QueryOptions& options) {
  constexpr const char* kCall = "KNearest";
  CheckLimit(kCall, "max_distance", max_distance);
  if (!distances.empty() && distances.size() != ids.size()) {
    kernels::ThrowInvalid(kCall, "distances",
                          "as many as ids, " + std::to_string(ids.size()),
                          std::to_string(distances.size()));
  }
  kernels::CheckMemory(kCall, "ids", ids.data(), ids.size(),
                       alignof(std::uint32_t));
  kernels::CheckMemory(kCall, "distances", distances.data(), distances.size(),
                       alignof(float));
  const auto& kernels = KernelsFor(options, kCall);
  if (tree.size() == 0) return 0;
  NearestSearch search = SearchFrom(tree, dims, point, max_distance, options);
  return kernels::InDefaultFpMode([&] {
    return WriteNearest(kernels, search, ids, distances, tree.size());
  });
}

void BvhForEachNearest(const BvhTree& tree, std::size_t dims,
                       const float* point, float max_distance,
                       NearFunction function, void* context,
                       const QueryOptions& options) {
  constexpr const char* kCall = "ForEachNearest";
  CheckLimit(kCall, "max_distance", max_distance);
  const auto& kernels = KernelsFor(options, kCall);
  if (tree.size() == 0) return;
  NearestSearch search = SearchFrom(tree, dims, point, max_distance, options);
  Call(kernels, search, function, context);
}

void BvhRayCast(const BvhTree& tree, std::size_t dims, const float* ray,
                float radius, NearFunction function, void* context,
                const QueryOptions& options) {
  constexpr const char* kCall = "RayCast";
  CheckLimit(kCall, "ray.max_t", ray[2 * dims]);
  CheckLimit(kCall, "radius", radius);
  const auto& kernels = KernelsFor(options, kCall);
  if (tree.size() == 0) return;
  NearestSearch search{};
  Line line;
  search.levels = &tree.levels();
  search.line = &line;
  search.mask = options.mask;
  kernels::InDefaultFpMode([&] {
    double origin[3] = {};
    double direction[3] = {};
    for (std::size_t k = 0; k < dims; ++k) {
      origin[k] = ray[k];
      direction[k] = ray[dims + k];
    }
    MakeLine({dims, tree.shape().axes, tree.shape().has_max}, origin, direction,
             ray[2 * dims], radius, line);
    search.limit = KeyLimit(true, ray[2 * dims]);
  });
  Call(kernels, search, function, context);
}

}  // namespace halfspace::detail
