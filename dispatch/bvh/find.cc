// The calls of bvh.h: checks, and what becomes of the ids.
#include <algorithm>

#include "dispatch/bvh/layout.h"
#include "halfspace/bvh.h"
#include "kernels/bvh/block.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// Ids that go to the caller's memory while that has room for a block, and to a
// buffer then.
struct IdsToSpan : WalkIds {
  explicit IdsToSpan(Span<std::uint32_t> to) : span(to) {
    next = span.data();
    end = next + span.size();
    make_room = [](WalkIds& ids) {
      static_cast<IdsToSpan&>(ids).Flush();
      return true;
    };
    end_of_query = [](WalkIds& ids, std::size_t query) {
      auto& all = static_cast<IdsToSpan&>(ids);
      if (all.offsets != nullptr) all.offsets[query + 1] = all.Total();
      return true;
    };
  }

  std::size_t Total() const {
    return total + static_cast<std::size_t>(
                       next - (is_buffered ? buffer : span.data()));
  }

  void Flush() {
    if (is_buffered && total < span.size()) {
      std::copy_n(buffer,
                  std::min<std::size_t>(next - buffer, span.size() - total),
                  span.data() + total);
    }
    total = Total();
    is_buffered = true;
    next = buffer;
    end = buffer + kRoom;
  }

  static constexpr std::size_t kRoom = 4 * kBlockObjects;
  Span<std::uint32_t> span;
  std::size_t* offsets = nullptr;  // of the queries that walk
  std::size_t total = 0;           // before `next` began
  bool is_buffered = false;
  std::uint32_t buffer[kRoom];
};

// Ids that a function takes, some at a time.
struct IdsToFunction : WalkIds {
  IdsToFunction(IdsFunction to, void* its_context)
      : function(to), context(its_context) {
    next = buffer;
    end = buffer + kRoom;
    make_room = [](WalkIds& ids) {
      return static_cast<IdsToFunction&>(ids).Flush();
    };
    end_of_query = [](WalkIds& ids, std::size_t) {
      return static_cast<IdsToFunction&>(ids).Flush();
    };
  }

  bool Flush() {
    const auto count = static_cast<std::size_t>(next - buffer);
    next = buffer;
    return count == 0 || function(context, {buffer, count});
  }

  static constexpr std::size_t kRoom = 512;
  IdsFunction function;
  void* context;
  std::uint32_t buffer[kRoom];
};

}  // namespace

std::size_t BvhSurvivors(const BvhTree& tree, const float* query,
                         Span<std::uint32_t> ids, const QueryOptions& options,
                         const WalkShape* shape) {
  const auto& kernels = KernelsFor(tree.shape(), options.target, "Survivors");
  kernels::CheckMemory("Survivors", "ids", ids.data(), ids.size(),
                       alignof(std::uint32_t));
  if (tree.size() == 0) return 0;
  IdsToSpan to(ids);
  kernels.find({&tree.levels(), query, 1, &to, nullptr, options.mask, shape});
  if (to.is_buffered) to.Flush();
  return to.Total();
}

std::size_t BvhCount(const BvhTree& tree, const float* query,
                     const QueryOptions& options, const WalkShape* shape) {
  const auto& kernels =
      KernelsFor(tree.shape(), options.target, "CountSurvivors");
  if (tree.size() == 0) return 0;
  std::size_t count = 0;
  kernels.count(
      {&tree.levels(), query, 1, nullptr, &count, options.mask, shape});
  return count;
}

bool BvhAny(const BvhTree& tree, const float* query, std::uint32_t& id,
            const QueryOptions& options, const WalkShape* shape) {
  const auto& kernels = KernelsFor(tree.shape(), options.target, "AnySurvivor");
  if (tree.size() == 0) return false;
  // Full after the first survivors.
  std::uint32_t buffer[kBlockObjects];
  WalkIds first{buffer, buffer + kBlockObjects, [](WalkIds&) { return false; },
                [](WalkIds&, std::size_t) { return true; }};
  kernels.find(
      {&tree.levels(), query, 1, &first, nullptr, options.mask, shape});
  if (first.next == buffer) return false;
  id = buffer[0];
  return true;
}

void BvhForEach(const BvhTree& tree, const float* query, IdsFunction function,
                void* context, const QueryOptions& options,
                const WalkShape* shape) {
  const auto& kernels =
      KernelsFor(tree.shape(), options.target, "ForEachSurvivor");
  if (tree.size() == 0) return;
  IdsToFunction to(function, context);
  kernels.find({&tree.levels(), query, 1, &to, nullptr, options.mask, shape});
}

std::size_t BvhSurvivorsOfMany(const BvhTree& tree, const float* queries,
                               std::size_t query_count, Span<std::uint32_t> ids,
                               Span<std::size_t> offsets,
                               const QueryOptions& options) {
  constexpr const char* kCall = "SurvivorsOfEach";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  CheckOfEach(kCall, queries, query_count, alignof(float), ids, offsets);
  offsets[0] = 0;
  if (tree.size() == 0) {
    std::fill_n(offsets.data(), query_count + 1, 0);
    return 0;
  }
  IdsToSpan to(ids);
  to.offsets = offsets.data();
  kernels.find(
      {&tree.levels(), queries, query_count, &to, nullptr, options.mask});
  if (to.is_buffered) to.Flush();
  return to.Total();
}

}  // namespace halfspace::detail
