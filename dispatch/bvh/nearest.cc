// The calls of bvh_nearest.h.
#include "kernels/bvh/nearest.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>

#include "dispatch/bvh/ball.h"
#include "dispatch/bvh/shape_query.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"

namespace halfspace::detail {
namespace {

// The greatest key of objects within a distance. It is finite, so that no
// infinite key is found. In the default floating-point mode, the error of a
// squared distance is less than 2^-21 of it plus 3 * 2^-150 (docs/bvh.md).
float KeyLimit(float value) {
  const double limit = double{value} * value * (1 + 0x1p-20) + 0x1p-148;
  return static_cast<float>(std::min(limit, double{kMax<float>}));
}

// The number of objects that one search finds on the stack. The searches for a
// function begin with fewer, because it may end them soon.
constexpr std::size_t kMostRoom = 2048;
constexpr std::size_t kFirstRoom = 8;

// A function of the caller's, which runs in the caller's floating-point mode.
struct NearCallback {
  NearFunction function;
  void* context;
  dispatch::DefaultFpMode& mode;

  static float Run(void* callback, std::uint32_t id, float value,
                   const float* planes) {
    const auto& call = *static_cast<NearCallback*>(callback);
    return call.mode.Outside(
        [&] { return call.function(call.context, id, value, planes); });
  }
};

// A function of the caller's that the kernel calls for the box around a ball.
// It runs only for objects that the ball touches.
struct BallCallback {
  NearCallback call;
  BallCast ball;
  float limit;

  static float Run(void* callback, std::uint32_t id, float /*of_box*/,
                   const float* planes) {
    auto& self = *static_cast<BallCallback*>(callback);
    const float t = self.ball.EntryOf(planes);
    if (t <= self.limit + kApartOnLine) {
      const float limit =
          NearCallback::Run(&self.call, id, ReportedTime(t), planes);
      if (limit < self.limit) self.limit = limit;
    }
    return self.limit;
  }
};

void CheckOutputs(const char* call, float max_distance, Span<std::uint32_t> ids,
                  Span<float> distances) {
  dispatch::CheckLength(call, "max_distance", max_distance);
  if (!distances.empty() && distances.size() != ids.size()) {
    dispatch::ThrowInvalid(call, "distances",
                           "as many as ids, " + std::to_string(ids.size()),
                           std::to_string(distances.size()));
  }
  dispatch::CheckMemory(call, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
  dispatch::CheckMemory(call, "distances", distances.data(), distances.size(),
                        alignof(float));
}

const BvhNearestKernels& KernelsFor(const SearchOptions& options,
                                    const char* call) {
  return KernelsOfAll<BvhNearestKernels>::kTargets[dispatch::IndexOf(
      options.target, call)];
}

NearestSearch MakeSearch(const BvhTree& tree, const SearchOptions& options) {
  NearestSearch search;
  search.levels = &tree.levels();
  search.box.dims = tree.type().dims;
  search.box.max_plane = tree.type().first_max;
  search.mask = options.mask;
  search.is_exclusive = options.exclusive;
  return search;
}

// Sets the query and the limit of a search.
void SetQuery(const NearQueries& queries, std::size_t q, float limit,
              NearestSearch& search) {
  const float* const low = queries.values + q * queries.stride;
  for (std::size_t k = 0; k < search.box.dims; ++k) {
    search.box.low[k] = low[k];
    search.box.high[k] = low[queries.upper + k];
  }
  search.from = 0;
  search.limit = limit;
}

// Up to kMostRoom objects are found on the stack. More are found in the memory
// of the ids. A keyed slot takes the memory of two ids, so each search finds
// half of the rest.
std::size_t WriteNearest(const BvhNearestKernels& kernels,
                         NearestSearch& search, Span<std::uint32_t> ids,
                         Span<float> distances) {
  const std::size_t most = std::min(search.levels->level[0].size, ids.size());
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
  const BvhLevel& objects = search.levels->level[0];
  KeyedSlot found[kMostRoom];
  search.found = found;
  for (search.room = kFirstRoom;;
       search.room = std::min(2 * search.room, kMostRoom)) {
    std::size_t i = 0;
    std::size_t count = 0;
    float distance = 0;
    const auto has_next = [&] {
      if (i == count) return false;
      const float key = KeyOf(found[i]);
      distance = std::sqrt(key);
      return key <= search.limit;
    };
    bool goes_on = dispatch::InDefaultFpMode([&] {
      count = kernels.find(search);
      return has_next();
    });
    while (goes_on) {
      const auto slot = static_cast<std::uint32_t>(found[i]);
      const float limit = function(context, search.levels->ids[slot], distance,
                                   &objects.Value(0, slot));
      goes_on = dispatch::InDefaultFpMode([&] {
        if (limit < 0) return false;
        if (limit <= kMax<float>) {
          search.limit = std::min(search.limit, KeyLimit(limit));
        }
        ++i;
        return has_next();
      });
    }
    if (i < search.room) return;
    search.from = found[i - 1] + 1;
  }
}

// Throws if the cast is invalid. Returns the kernels of the target.
const BvhNearestKernels& CheckCast(const LineCast& cast, Target target) {
  dispatch::CheckLength(cast.call, "max_t", cast.max_t);
  dispatch::CheckLength(cast.call, "radius", cast.radius);
  return KernelsOfAll<BvhNearestKernels>::kTargets[dispatch::IndexOf(
      target, cast.call)];
}

// Called in the default floating-point mode. Returns false if the box is empty.
bool MakeCastLine(const PlaneLayout& layout, const LineCast& cast, Line& line) {
  double low[3];
  double high[3];
  double direction[3];
  for (std::size_t k = 0; k < layout.dims; ++k) {
    if (cast.low[k] > cast.high[k]) return false;
    low[k] = cast.low[k];
    high[k] = cast.high[k];
    direction[k] = cast.direction[k];
  }
  MakeLine(layout, low, high, direction, cast.max_t, cast.radius, line);
  line.max_t = std::min(cast.max_t, float{kMax<float>});
  return true;
}

}  // namespace

std::size_t BvhTree::Nearest(const NearQueries& query, float max_distance,
                             Span<std::uint32_t> ids, Span<float> distances,
                             const SearchOptions& options) const {
  constexpr const char* kCall = "KNearest";
  CheckOutputs(kCall, max_distance, ids, distances);
  const auto& kernels = KernelsFor(options, kCall);
  if (FindsNothing(*this, options.mask)) return 0;
  NearestSearch search = MakeSearch(*this, options);
  return dispatch::InDefaultFpMode([&] {
    SetQuery(query, 0, KeyLimit(max_distance), search);
    return WriteNearest(kernels, search, ids, distances);
  });
}

void BvhTree::NearestOfEach(const NearQueries& queries, std::size_t k,
                            float max_distance, Span<std::uint32_t> ids,
                            Span<float> distances,
                            const SearchOptions& options) const {
  constexpr const char* kCall = "KNearestOfEach";
  dispatch::CheckMemory(kCall, "queries", queries.values, queries.count,
                        alignof(float));
  CheckOutputs(kCall, max_distance, ids, distances);
  if (k == 0 ? !ids.empty()
             : ids.size() % k != 0 || ids.size() / k != queries.count) {
    dispatch::ThrowInvalid(kCall, "ids",
                           std::to_string(k) + " elements for each of " +
                               std::to_string(queries.count) + " queries",
                           std::to_string(ids.size()));
  }
  const auto& kernels = KernelsFor(options, kCall);
  NearestSearch search = MakeSearch(*this, options);
  dispatch::InDefaultFpMode([&] {
    const float limit = KeyLimit(max_distance);
    for (std::size_t row = 0; row < ids.size(); row += k) {
      const Span<std::uint32_t> row_ids(ids.data() + row, k);
      const Span<float> row_distances =
          distances.empty() ? Span<float>()
                            : Span<float>(distances.data() + row, k);
      std::size_t found = 0;
      if (!FindsNothing(*this, options.mask)) {
        SetQuery(queries, row / k, limit, search);
        found = WriteNearest(kernels, search, row_ids, row_distances);
      }
      std::fill(row_ids.begin() + found, row_ids.end(), kNoId);
      if (distances.empty()) continue;
      std::fill(row_distances.begin() + found, row_distances.end(),
                float{kInf<float>});
    }
  });
}

void BvhTree::ForEachNearest(const NearQueries& query, float max_distance,
                             NearFunction function, void* context,
                             const SearchOptions& options) const {
  constexpr const char* kCall = "ForEachNearest";
  dispatch::CheckLength(kCall, "max_distance", max_distance);
  const auto& kernels = KernelsFor(options, kCall);
  if (FindsNothing(*this, options.mask)) return;
  NearestSearch search = MakeSearch(*this, options);
  dispatch::InDefaultFpMode(
      [&] { SetQuery(query, 0, KeyLimit(max_distance), search); });
  Call(kernels, search, function, context);
}

void BvhTree::Cast(const LineCast& cast, NearFunction function, void* context,
                   const SearchOptions& options) const {
  const auto& kernels = CheckCast(cast, options.target);
  if (FindsNothing(*this, options.mask)) return;
  LineSearch search;
  search.levels = &levels();
  search.mask = options.mask;
  dispatch::DefaultFpMode mode;
  NearCallback callback = {function, context, mode};
  search.function = &NearCallback::Run;
  search.context = &callback;
  const bool is_ball = cast.is_round && cast.radius > 0;
  dispatch::CallApart([&] {
    if (!MakeCastLine(type(), cast, search.line)) return;
    if (!is_ball) return kernels.cast(search);
    const Line line = search.line;
    BallCallback of_ball = {callback, {type(), cast, line}, line.max_t};
    search.function = &BallCallback::Run;
    search.context = &of_ball;
    kernels.cast(search);
  });
}

}  // namespace halfspace::detail
