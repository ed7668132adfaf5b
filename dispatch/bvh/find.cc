// The queries of bvh.h.
#include <algorithm>
#include <string>

#include "dispatch/bvh/tree.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "halfspace/bvh.h"

namespace halfspace::detail {
namespace {

// Walks for all queries. Finds ids if `ids` is not null, and counts otherwise.
void RunWalks(const BvhTree& tree, const BvhQueries& queries,
              const QueryOptions& options, const char* call,
              const BvhKernels::OfPlanes& kernels, WalkIds* ids,
              std::size_t* counts, bool is_urgent = false) {
  const Walk walk = {.levels = &tree.levels(),
                     .queries = queries.first,
                     .query_count = queries.count,
                     .ids = ids,
                     .counts = counts,
                     .mask = options.mask,
                     .statistics = options.statistics,
                     .is_urgent = is_urgent};
  if (queries.kind != nullptr) {
    queries.kind->walk(tree.type(), queries, options, call, walk);
  } else if (!FindsNothing(tree, options.mask)) {
    (ids != nullptr ? kernels.find : kernels.count)(walk);
  }
}

// Throws if an array of a call for several queries is null, misaligned or too
// short.
void CheckOfEach(const char* call, const void* queries, std::size_t query_count,
                 std::size_t alignment, Span<std::uint32_t> ids,
                 Span<std::size_t> offsets) {
  dispatch::CheckMemory(call, "queries", queries, query_count, alignment);
  dispatch::CheckMemory(call, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
  if (offsets.size() <= query_count) {
    dispatch::ThrowInvalid(call, "offsets",
                           "at least " + std::to_string(query_count + 1) +
                               " elements, one more than the queries",
                           std::to_string(offsets.size()));
  }
  dispatch::CheckMemory(call, "offsets", offsets.data(), offsets.size(),
                        alignof(std::size_t));
}

}  // namespace

std::size_t BvhTree::Survivors(const BvhQueries& query, Span<std::uint32_t> ids,
                               const QueryOptions& options,
                               std::size_t skip) const {
  constexpr const char* kCall = "Survivors";
  const auto& kernels = KernelsFor(type(), options.target, kCall);
  dispatch::CheckMemory(kCall, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
  IdSink to(ids, skip);
  RunWalks(*this, query, options, kCall, kernels, &to, nullptr);
  to.Flush();
  return to.flushed;
}

std::size_t BvhTree::Count(const BvhQueries& query,
                           const QueryOptions& options) const {
  constexpr const char* kCall = "CountSurvivors";
  const auto& kernels = KernelsFor(type(), options.target, kCall);
  std::size_t count = 0;
  RunWalks(*this, query, options, kCall, kernels, nullptr, &count);
  return count;
}

void BvhTree::CountOfEach(const BvhQueries& queries, Span<std::size_t> counts,
                          const QueryOptions& options) const {
  constexpr const char* kCall = "CountSurvivorsOfEach";
  const auto& kernels = KernelsFor(type(), options.target, kCall);
  dispatch::CheckMemory(kCall, "queries", queries.first, queries.count,
                        alignof(float));
  if (counts.size() < queries.count) {
    dispatch::ThrowInvalid(
        kCall, "counts",
        "at least one for each query, " + std::to_string(queries.count),
        std::to_string(counts.size()));
  }
  dispatch::CheckMemory(kCall, "counts", counts.data(), counts.size(),
                        alignof(std::size_t));
  std::fill_n(counts.data(), queries.count, 0);
  RunWalks(*this, queries, options, kCall, kernels, nullptr, counts.data());
}

bool BvhTree::Any(const BvhQueries& query, std::uint32_t& id,
                  const QueryOptions& options) const {
  constexpr const char* kCall = "AnySurvivor";
  const auto& kernels = KernelsFor(type(), options.target, kCall);
  std::uint32_t buffer[kBlockObjects];
  WalkIds first{{buffer, buffer, buffer + 1,
                 [](Results<std::uint32_t>&) { return false; }, 0},
                nullptr};
  RunWalks(*this, query, options, kCall, kernels, &first, nullptr, true);
  if (first.next == buffer) return false;
  id = buffer[0];
  return true;
}

void BvhTree::ForEach(const BvhQueries& query, IdsFunction function,
                      void* context, const QueryOptions& options) const {
  constexpr const char* kCall = "ForEachSurvivor";
  const auto& kernels = KernelsFor(type(), options.target, kCall);
  IdSink to(function, context);
  to.full = to.begin + 1;  // the ids of the first leaf are wanted soon
  RunWalks(*this, query, options, kCall, kernels, &to, nullptr, true);
  to.Flush();
}

std::size_t BvhTree::SurvivorsOfEach(const BvhQueries& queries,
                                     Span<std::uint32_t> ids,
                                     Span<std::size_t> offsets,
                                     const QueryOptions& options,
                                     std::size_t skip) const {
  constexpr const char* kCall = "SurvivorsOfEach";
  const auto& kernels = KernelsFor(type(), options.target, kCall);
  CheckOfEach(
      kCall, queries.first, queries.count,
      queries.kind != nullptr ? queries.kind->alignment : alignof(float), ids,
      offsets);
  IdSink to(ids, skip);
  to.offsets = offsets.data();
  RunWalks(*this, queries, options, kCall, kernels, &to, nullptr);
  offsets[0] = 0;
  // RunWalks() has then run no walk, so no offset is written.
  if (FindsNothing(*this, options.mask)) {
    std::fill_n(offsets.data(), queries.count + 1, 0);
  }
  to.Flush();
  return to.flushed;
}

}  // namespace halfspace::detail
