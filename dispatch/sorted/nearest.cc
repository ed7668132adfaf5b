// The calls of sorted_nearest.h: checks, and one search after another for what
// comes next.
#include "kernels/sorted/nearest.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/sorted.h"
#include "halfspace/sorted_nearest.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// The key up to which objects are found that are within a distance, or not
// beyond a place on a line: finite, so that what is nowhere is never found.
float KeyLimit(bool is_line, float value) {
  const float limit = is_line ? value + kApartOnLine : SquaredLimit(value);
  // The greatest float is what overflows become in some rounding modes.
  return std::min(limit, 0x1.fffffcp127f);
}

void CheckLimit(const char* call, const char* argument, float value) {
  kernels::InDefaultFpMode([&] {
    if (value >= 0) return;
    kernels::ThrowInvalid(call, argument, "a number that is not negative",
                          std::to_string(value));
  });
}

// So many are found at once at first, and at most.
constexpr std::size_t kFirstRoom = 8;
constexpr std::size_t kMostRoom = 256;

// Calls take(id, key) for the objects in ascending order, `most` of them at
// most, until it returns false. It may lower search.limit.
template <typename Take>
void ForEachFound(NearestSearch& search, const SortedOptions& options,
                  const char* call, std::size_t first_room, std::size_t most,
                  const Take& take) {
  const auto& kernels =
      kSortedNearestKernels[dispatch::IndexOf(options.target, call)];
  KeyedSlot found[kMostRoom];
  search.found = found;
  search.categories = options.categories;
  for (std::size_t room = first_room; most > 0;
       room = std::min(2 * room, kMostRoom)) {
    search.room = std::min(room, most);
    const std::size_t count = kernels.find(search);
    for (std::size_t i = 0; i < count; ++i) {
      const auto key =
          std::bit_cast<float>(static_cast<std::uint32_t>(found[i] >> 32));
      const auto slot = static_cast<std::uint32_t>(found[i]);
      if (key > search.limit || !take(search.levels->ids[slot], key)) return;
    }
    if (count < search.room) return;
    search.from = found[count - 1] + 1;
    most -= count;
  }
}

NearestSearch SearchFrom(const SortedTree& tree, std::size_t dims,
                         const float* point, float max_distance) {
  NearestSearch search{};
  search.levels = &tree.levels();
  kernels::InDefaultFpMode([&] {
    search.ball =
        MakeBall({dims, tree.shape().axes, tree.shape().has_max}, point, 0);
    search.limit = KeyLimit(false, max_distance);
  });
  return search;
}

// Calls the function until it ends the search.
void Call(NearestSearch& search, const SortedOptions& options, const char* call,
          NearFunction function, void* context) {
  const bool is_line = search.line != nullptr;
  ForEachFound(search, options, call, kFirstRoom,
               std::numeric_limits<std::size_t>::max(),
               [&](std::uint32_t id, float key) {
                 const float limit =
                     function(context, id, is_line ? key : std::sqrt(key));
                 return kernels::InDefaultFpMode([&] {
                   if (limit < 0) return false;
                   if (limit <= kMax<float>) {
                     search.limit =
                         std::min(search.limit, KeyLimit(is_line, limit));
                   }
                   return true;
                 });
               });
}

}  // namespace

std::size_t SortedNearest(const SortedTree& tree, std::size_t dims,
                          const float* point, float max_distance,
                          Span<std::uint32_t> ids, Span<float> distances,
                          const SortedOptions& options) {
  constexpr const char* kCall = "NearestObjects";
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
  std::ignore = dispatch::IndexOf(options.target, kCall);
  if (tree.size() == 0) return 0;
  NearestSearch search = SearchFrom(tree, dims, point, max_distance);
  std::size_t count = 0;
  ForEachFound(search, options, kCall, kMostRoom, ids.size(),
               [&](std::uint32_t id, float key) {
                 ids[count] = id;
                 if (!distances.empty()) distances[count] = std::sqrt(key);
                 ++count;
                 return true;
               });
  return count;
}

void SortedForEachNearest(const SortedTree& tree, std::size_t dims,
                          const float* point, float max_distance,
                          NearFunction function, void* context,
                          const SortedOptions& options) {
  constexpr const char* kCall = "ForEachNearest";
  CheckLimit(kCall, "max_distance", max_distance);
  std::ignore = dispatch::IndexOf(options.target, kCall);
  if (tree.size() == 0) return;
  NearestSearch search = SearchFrom(tree, dims, point, max_distance);
  Call(search, options, kCall, function, context);
}

void SortedForEachAlongRay(const SortedTree& tree, std::size_t dims,
                           const float* ray, float radius,
                           NearFunction function, void* context,
                           const SortedOptions& options) {
  constexpr const char* kCall = "ForEachAlongRay";
  CheckLimit(kCall, "ray.max_t", ray[2 * dims]);
  CheckLimit(kCall, "radius", radius);
  std::ignore = dispatch::IndexOf(options.target, kCall);
  if (tree.size() == 0) return;
  NearestSearch search{};
  Line line;
  search.levels = &tree.levels();
  search.line = &line;
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
  Call(search, options, kCall, function, context);
}

}  // namespace halfspace::detail
