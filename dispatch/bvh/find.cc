// The calls of bvh.h: checks, and what becomes of the ids.
#include <algorithm>
#include <string>

#include "dispatch/bvh/layout.h"
#include "halfspace/bvh.h"
#include "kernels/bvh/block.h"
#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// Ids that go to the caller's memory while that has room for a block, and to a
// buffer then, or if some are skipped.
struct IdsToSpan : WalkIds {
  IdsToSpan(Span<std::uint32_t> to, std::size_t skipped,
            std::size_t* first_offset = nullptr)
      : span(to), skip(skipped) {
    flushed = 0;
    offsets = first_offset;
    flush = [](WalkIds& ids) {
      static_cast<IdsToSpan&>(ids).Flush();
      return true;
    };
    if (skip != 0 || span.size() < kBlockObjects) {
      UseBuffer();
    } else {
      Use(span.data(), span.size());
    }
  }

  void UseBuffer() { Use(buffer, kRoom); }
  void Use(std::uint32_t* memory, std::size_t room) {
    begin = next = memory;
    full = memory + (room - kBlockObjects + 1);
  }

  void Flush() {
    const std::size_t end = Total();
    if (begin == buffer && end > skip) {
      const std::size_t first = std::max(flushed, skip);
      const std::size_t written = first - skip;
      if (written < span.size()) {
        std::copy_n(buffer + (first - flushed),
                    std::min(end - first, span.size() - written),
                    span.data() + written);
      }
    }
    flushed = end;
    UseBuffer();
  }

  // Writes what is in the buffer, and returns the number of all ids.
  std::size_t End() {
    if (begin == buffer) Flush();
    return Total();
  }

  static constexpr std::size_t kRoom = 4 * kBlockObjects;
  Span<std::uint32_t> span;
  std::size_t skip;
  std::uint32_t buffer[kRoom];
};

// Ids that a function takes: first those of one leaf, then up to kRoom at a
// time.
struct IdsToFunction : WalkIds {
  IdsToFunction(IdsFunction to, void* its_context)
      : WalkIds{buffer,
                buffer,
                buffer + 1,
                [](WalkIds& ids) {
                  return static_cast<IdsToFunction&>(ids).Flush();
                },
                0,
                nullptr},
        function(to),
        context(its_context) {}

  bool Flush() {
    const Span<const std::uint32_t> ids(
        buffer, static_cast<std::size_t>(next - buffer));
    next = buffer;
    full = buffer + kRoom - kBlockObjects + 1;
    return ids.empty() || function(context, ids);
  }

  static constexpr std::size_t kRoom = 512;
  IdsFunction function;
  void* context;
  std::uint32_t buffer[kRoom];
};

// The walks of all queries: to find with `ids`, and else to count.
void RunWalks(const BvhTree& tree, const BvhQueries& queries,
              const QueryOptions& options, const char* call,
              const BvhKernels::OfPlanes& kernels, WalkIds* ids,
              std::size_t* counts, bool is_urgent = false) {
  const Walk walk = {
      &tree.levels(), queries.first, queries.count,      ids,
      counts,         options.mask,  options.statistics, is_urgent};
  if (queries.kind != nullptr) {
    queries.kind->walk(tree.shape(), queries, options, call, walk);
  } else if (!FindsNothing(tree, options.mask)) {
    (ids != nullptr ? kernels.find : kernels.count)(walk);
  }
}

}  // namespace

std::size_t BvhSurvivors(const BvhTree& tree, const BvhQueries& query,
                         Span<std::uint32_t> ids, const QueryOptions& options,
                         std::size_t skip) {
  constexpr const char* kCall = "Survivors";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  kernels::CheckMemory(kCall, "ids", ids.data(), ids.size(),
                       alignof(std::uint32_t));
  IdsToSpan to(ids, skip);
  RunWalks(tree, query, options, kCall, kernels, &to, nullptr);
  return to.End();
}

std::size_t BvhCount(const BvhTree& tree, const BvhQueries& query,
                     const QueryOptions& options) {
  constexpr const char* kCall = "CountSurvivors";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  std::size_t count = 0;
  RunWalks(tree, query, options, kCall, kernels, nullptr, &count);
  return count;
}

void BvhCountOfEach(const BvhTree& tree, const BvhQueries& queries,
                    Span<std::size_t> counts, const QueryOptions& options) {
  constexpr const char* kCall = "CountSurvivorsOfEach";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  kernels::CheckMemory(kCall, "queries", queries.first, queries.count,
                       alignof(float));
  if (counts.size() < queries.count) {
    kernels::ThrowInvalid(
        kCall, "counts",
        "at least one for each query, " + std::to_string(queries.count),
        std::to_string(counts.size()));
  }
  kernels::CheckMemory(kCall, "counts", counts.data(), counts.size(),
                       alignof(std::size_t));
  std::fill_n(counts.data(), queries.count, 0);
  RunWalks(tree, queries, options, kCall, kernels, nullptr, counts.data());
}

bool BvhAny(const BvhTree& tree, const BvhQueries& query, std::uint32_t& id,
            const QueryOptions& options) {
  constexpr const char* kCall = "AnySurvivor";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  std::uint32_t buffer[kBlockObjects];
  WalkIds first{buffer, buffer, buffer + 1, [](WalkIds&) { return false; },
                0,      nullptr};
  RunWalks(tree, query, options, kCall, kernels, &first, nullptr, true);
  if (first.next == buffer) return false;
  id = buffer[0];
  return true;
}

void BvhForEach(const BvhTree& tree, const BvhQueries& query,
                IdsFunction function, void* context,
                const QueryOptions& options) {
  constexpr const char* kCall = "ForEachSurvivor";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  IdsToFunction to(function, context);
  RunWalks(tree, query, options, kCall, kernels, &to, nullptr, true);
  to.Flush();
}

std::size_t BvhSurvivorsOfEach(const BvhTree& tree, const BvhQueries& queries,
                               Span<std::uint32_t> ids,
                               Span<std::size_t> offsets,
                               const QueryOptions& options, std::size_t skip) {
  constexpr const char* kCall = "SurvivorsOfEach";
  const auto& kernels = KernelsFor(tree.shape(), options.target, kCall);
  CheckOfEach(
      kCall, queries.first, queries.count,
      queries.kind != nullptr ? queries.kind->alignment : alignof(float), ids,
      offsets);
  IdsToSpan to(ids, skip, offsets.data());
  RunWalks(tree, queries, options, kCall, kernels, &to, nullptr);
  offsets[0] = 0;
  // No query has walked.
  if (FindsNothing(tree, options.mask)) {
    std::fill_n(offsets.data(), queries.count + 1, 0);
  }
  return to.End();
}

}  // namespace halfspace::detail
