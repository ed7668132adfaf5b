// The preconditions of the calls for one query and for several: who broke
// which, and nothing written.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/reject_many.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kObjects = 130;  // 3 words
constexpr std::size_t kQueries = 5;
constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kTooMany = (std::size_t{1} << 32) + 1;

// An output of a call for `queries` queries: elements of `bytes` bytes, of
// which the call needs `needed`. A list may be shorter.
struct Output {
  std::string_view call;
  std::string_view argument;
  std::size_t queries;
  std::size_t bytes;
  std::size_t needed;
  std::string_view if_short;  // what a call expects then; empty for a list
  std::function<void(detail::Scan&&, void* begin, std::size_t size)> ask;
};

template <typename T>
Span<T> SpanOf(void* begin, std::size_t size) {
  return {static_cast<T*>(begin), size};
}

// The other list of pairs.
std::uint32_t other_indices[200];

const std::vector<Output> kOutputs = {
    {"RejectMask", "mask", 1, 8, 3, "at least 3 words for 130 objects",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       detail::RejectMask(std::move(scan), SpanOf<std::uint64_t>(to, size), {});
     }},
    {"SurvivorMask", "mask", 1, 8, 3, "at least 3 words for 130 objects",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       detail::SurvivorMask(std::move(scan), SpanOf<std::uint64_t>(to, size),
                            {});
     }},
    {"Survivors", "indices", 1, 4, 2, "",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       std::ignore = detail::Survivors(std::move(scan),
                                       SpanOf<std::uint32_t>(to, size), {}, 0);
     }},
    {"SurvivorMasks", "rows", kQueries, 8, 15, "at least 5 rows of 3 words",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       detail::SurvivorMasks(std::move(scan), SpanOf<std::uint64_t>(to, size),
                             {}, 0);
     }},
    {"SurvivorPairs", "query_indices", kQueries, 4, 2, "",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       std::ignore = detail::SurvivorPairs(std::move(scan),
                                           SpanOf<std::uint32_t>(to, size),
                                           other_indices, {}, 0);
     }},
    {"SurvivorPairs", "object_indices", kQueries, 4, 2, "",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       std::ignore =
           detail::SurvivorPairs(std::move(scan), other_indices,
                                 SpanOf<std::uint32_t>(to, size), {}, 0);
     }},
    {"SurvivorCounts", "counts", kQueries, 8, 5, "at least 5",
     [](detail::Scan&& scan, void* to, std::size_t size) {
       detail::SurvivorCounts(std::move(scan), SpanOf<std::size_t>(to, size),
                              {});
     }},
};

class RejectErrorsTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  // As after a first call that succeeded: a call that has to find the target
  // checks everything.
  RejectErrorsTest() {
    dispatch::IndexOf({}, "RejectErrorsTest");
    for (std::size_t p = 0; p < kind_.layout.plane_count; ++p) {
      planes_[p] = Plane(p);
    }
  }

  // The first value of a plane. Planes are two elements apart from one another,
  // so that an output fits between. There is room before the first and behind
  // the last.
  std::byte* Plane(std::size_t p) {
    return block_.data() + (2 + p * (kObjects + 2)) * bytes_;
  }

  AnyWorld World(std::size_t size = kObjects) const {
    return kind_.world(planes_, size);
  }
  AnyQueries Queries(std::size_t count = kQueries) const {
    return {queries_.data(), count};
  }

  // The calls of a kind that `world` allows refuse an output.
  void ExpectRefused(const Output& output, const AnyWorld& world, void* begin,
                     std::size_t size, std::string_view expected,
                     std::string_view given) {
    const std::vector<std::byte> block = block_;
    const std::vector<std::byte> queries = queries_;
    std::memset(other_indices, 7, sizeof(other_indices));
    EXPECT_REFUSED(
        (output.ask(world.Asked(Queries(output.queries)), begin, size)),
        output.call, ": ", output.argument, ": expected", expected, "got",
        given);
    EXPECT_EQ(block_, block);
    EXPECT_EQ(queries_, queries);
    for (std::uint32_t index : other_indices) EXPECT_EQ(index, 0x07070707u);
  }

  const FlatCase& kind_ = GetParam();
  const std::size_t bytes_ = kind_.scalar_bytes();
  // Zeros, so that all objects touch all queries.
  std::vector<std::byte> block_ =
      std::vector<std::byte>((2 + 12 * (kObjects + 2)) * bytes_);
  std::vector<std::byte> queries_ =
      std::vector<std::byte>(64 * kind_.query_bytes());
  PlanePointers planes_{};
};

TEST_P(RejectErrorsTest, BadPlanes) {
  for (std::size_t p = 0; p < kind_.layout.plane_count; ++p) {
    planes_[p] = nullptr;
    ExpectAllRefuse(
        World(), Queries(), {}, kind_.PlaneName(p),
        kind_.is_double ? "a plane of 130 doubles" : "a plane of 130 floats",
        "a null pointer");
    // The range is no excuse.
    ExpectAllRefuse(World(), Queries(), {.range = {64, 64}}, kind_.PlaneName(p),
                    "a plane of 130", "a null pointer");
    planes_[p] = Misaligned(Plane(p));
    ExpectAllRefuse(World(), Queries(), {}, kind_.PlaneName(p),
                    kind_.is_double ? "a pointer aligned to 8 bytes"
                                    : "a pointer aligned to 4 bytes",
                    "a misaligned one");
    planes_[p] = Plane(p);
  }
}

TEST_P(RejectErrorsTest, SizeBeyondTheAddressSpace) {
  for (std::size_t size : {kMost / bytes_ + 1, kMost}) {
    ExpectAllRefuse(World(size), Queries(), {}, "world.size",
                    "fits the address space", std::to_string(size));
  }
}

// The size of the work is no excuse.
TEST_P(RejectErrorsTest, BadOptions) {
  for (const AnyWorld& world : {World(), World(0)}) {
    for (std::size_t count : {kQueries, std::size_t{0}}) {
      ExpectAllRefuse(world, Queries(count),
                      {.schedule = static_cast<Schedule>(17)},
                      "options.schedule", "one of the enumerators", "17");
      ExpectAllRefuse(world, Queries(count),
                      {.target = Target::FromHighwayBit(3)}, "options.target",
                      "one of", "a bit that is no target");
    }
  }
}

TEST_P(RejectErrorsTest, RangeThatEndsBeforeItBegins) {
  // Also past the world, and at its last word.
  for (const Range& range :
       {Range{128, 64}, Range{8, 7}, Range{320, 256}, Range{192, kObjects}}) {
    for (std::size_t size : {kObjects, std::size_t{0}}) {
      ExpectAllRefuse(World(size), Queries(), {.range = range},
                      "options.range.end",
                      "not less than its begin, " + std::to_string(range.begin),
                      std::to_string(range.end));
    }
  }
}

// Also in a world where they would not be read.
TEST_P(RejectErrorsTest, BadQueries) {
  for (const AnyWorld& world : {World(), World(0)}) {
    ExpectAllRefuse(world, {nullptr, 3}, {}, "queries", "quer",
                    "a null pointer");
    ExpectAllRefuse(world, {Misaligned(queries_.data()), 4}, {}, "queries",
                    "aligned", "a misaligned one");
  }
}

TEST_P(RejectErrorsTest, OutputsThatAreNoMemory) {
  std::vector<std::uint64_t> memory(16, 7);
  for (const Output& output : kOutputs) {
    ExpectRefused(output, World(), nullptr, output.needed,
                  "room for the output", "a null pointer");
    ExpectRefused(output, World(), Misaligned(memory.data()), output.needed,
                  "aligned", "a misaligned one");
    if (output.if_short.empty()) continue;
    for (std::size_t size : {output.needed - 1, std::size_t{0}}) {
      ExpectRefused(output, World(), memory.data(), size, output.if_short,
                    std::to_string(size));
    }
  }
  EXPECT_EQ(memory, std::vector<std::uint64_t>(16, 7));
}

// By one element, at either end of the plane.
TEST_P(RejectErrorsTest, OutputOverlapsAPlane) {
  for (std::size_t p = 0; p < kind_.layout.plane_count; ++p) {
    for (const Output& output : kOutputs) {
      std::byte* const end = Plane(p) + kObjects * bytes_;
      for (std::byte* at : {Plane(p) - output.bytes, end - output.bytes}) {
        ExpectRefused(output, World(), at, output.needed,
                      "apart from the world's planes",
                      "an overlap with " + kind_.PlaneName(p));
      }
    }
  }
}

TEST_P(RejectErrorsTest, OutputOverlapsTheQueries) {
  for (const Output& output : kOutputs) {
    // In the first element that fits, and in the last.
    const std::size_t size =
        output.queries * kind_.query_bytes() / output.bytes * output.bytes;
    for (std::size_t at : {std::size_t{0}, size - output.bytes}) {
      ExpectRefused(output, World(), &queries_[at], output.needed,
                    "apart from the queries", "an overlap with them");
    }
  }
}

// Two elements lie between two planes: an output fits there exactly. And two
// objects have no more than two survivors: what else the span has room for is
// never written, and may be a plane.
TEST_P(RejectErrorsTest, OutputRightBesideAPlaneIsFine) {
  for (std::size_t p = 0; p + 1 < kind_.layout.plane_count; ++p) {
    std::byte* const gap = Plane(p) + kObjects * bytes_;
    planes_[p] = gap - 64 * bytes_;
    detail::RejectMask(World(64).Asked(Queries(1)),
                       SpanOf<std::uint64_t>(gap, 1), {});
    EXPECT_EQ(*reinterpret_cast<std::uint64_t*>(gap), 0u);
    const auto two = SpanOf<std::uint32_t>(gap, 2);
    EXPECT_EQ(detail::Survivors(World(64).Asked(Queries(1)), two, {}, 0), 64u);
    EXPECT_EQ(two[1], 1u);
    two[1] = 7;
    planes_[p] = gap - 2 * bytes_;
    EXPECT_EQ(detail::Survivors(World(2).Asked(Queries(1)),
                                SpanOf<std::uint32_t>(gap, 8), {}, 0),
              2u);
    EXPECT_EQ(two[1], 1u);
    planes_[p] = Plane(p);
  }
}

TEST_P(RejectErrorsTest, NothingNeedsNoPlanesAndNoOutput) {
  for (const Output& output : kOutputs) {
    if (output.queries == kQueries) output.ask(World().Asked({}), nullptr, 0);
  }
  planes_ = {};
  for (const Output& output : kOutputs) {
    if (output.argument == "counts") continue;
    output.ask(World(0).Asked(Queries(1)), nullptr, 0);
  }
  CallOutputs outputs;
  const auto call_it = [](std::string_view, const auto& call) { call(); };
  ForEachCall(World(0), Queries(1), {}, outputs, call_it);
  EXPECT_TRUE(outputs.Untouched());
  ForEachManyCall(World(0), {}, {}, outputs, call_it);
  EXPECT_TRUE(outputs.Untouched());
}

// Indices are the world's, so a range does not make them fit.
TEST_P(RejectErrorsTest, MoreObjectsOrQueriesThanIndices) {
  std::uint32_t first = 7;
  std::uint32_t second = 7;
  const AnyWorld huge = World(kTooMany);
  for (const Options& options : {Options(), Options{.range = {0, 64}}}) {
    EXPECT_REFUSED(
        (detail::Survivors(huge.Asked(Queries(1)), {&first, 1}, options, 0)),
        "Survivors: world.size: expected at most 2^32", "got 4294967297");
    const auto pairs = [&](std::size_t size, std::size_t count) {
      std::ignore =
          detail::SurvivorPairs(World(size).Asked(Queries(count)), {&first, 1},
                                {&second, 1}, options, 0);
    };
    EXPECT_REFUSED((pairs(kTooMany, 1)),
                   "SurvivorPairs: world.size: expected at most 2^32",
                   "4294967297");
    EXPECT_REFUSED((pairs(1, kTooMany)),
                   "SurvivorPairs: queries: expected at most 2^32",
                   "4294967297");
  }
  EXPECT_EQ(first, 7u);
  EXPECT_EQ(second, 7u);
}

// So many words that their number has no size_t: no span can be long enough.
TEST_P(RejectErrorsTest, MoreRowsThanTheAddressSpace) {
  std::vector<std::uint64_t> memory(16, 7);
  // 2^34 words a row. Of 2^30 queries and one more, the product wraps to few.
  const AnyWorld world = World(std::size_t{1} << 40);
  for (std::size_t count : {std::size_t{1} << 30, (std::size_t{1} << 30) + 1,
                            kMost / kind_.query_bytes()}) {
    for (const Output& output : kOutputs) {
      if (output.needed < kQueries) continue;
      EXPECT_REFUSED(
          (output.ask(world.Asked(Queries(count)), memory.data(), 16)),
          output.call, ": ", output.argument, ": expected", "at least",
          std::to_string(count), "16");
    }
  }
  EXPECT_EQ(memory, std::vector<std::uint64_t>(16, 7));
}

TEST_P(RejectErrorsTest, RowsThatOverlap) {
  std::vector<std::uint64_t> rows(100, 7);
  const auto masks = [&](std::size_t words, const Options& options,
                         std::size_t row_words) {
    detail::SurvivorMasks(World().Asked(Queries(3)),
                          std::span(rows).first(words), options, row_words);
  };
  EXPECT_REFUSED(
      (masks(100, {.range = {0, 129}}, 2)),
      "SurvivorMasks: row_words: expected 0, or at least the 3 words", "got 2");
  // Two rows of 20 words, and the 3 words of the last.
  const Options options{.range = {1, kObjects}};
  EXPECT_REFUSED((masks(42, options, 20)), "SurvivorMasks: rows: expected",
                 "at least 3 rows of 3 words, 20 words", "42 words");
  EXPECT_EQ(rows, std::vector<std::uint64_t>(100, 7));
  masks(43, options, 20);
  EXPECT_EQ(rows[42], 1u);
  EXPECT_EQ(rows[43], 7u);
  EXPECT_EQ(rows[3], 7u);
}

// By one element, or all, and in either order. What is never written may
// overlap: the longer list past the end of the shorter one, and either past the
// last pair there can be.
TEST_P(RejectErrorsTest, PairsThatOverlapOneAnother) {
  constexpr std::size_t kPairs = 4;
  using Indices = std::vector<std::uint32_t>;
  Indices room(3 * kPairs, 7);
  const auto pairs = [&](const detail::Scan& scan, std::size_t queries_at,
                         std::size_t queries_room, std::size_t objects_at,
                         std::size_t objects_room,
                         const Options& options = {}) {
    return detail::SurvivorPairs(detail::Scan(scan),
                                 {&room[queries_at], queries_room},
                                 {&room[objects_at], objects_room}, options, 0);
  };
  const AnyWorld world = World();
  const detail::Scan all = world.Asked(Queries());
  const auto refused = [&](std::size_t queries_at, std::size_t objects_at,
                           std::size_t objects_room) {
    EXPECT_REFUSED((pairs(all, queries_at, kPairs, objects_at, objects_room)),
                   "SurvivorPairs: object_indices: expected",
                   "memory apart from query_indices", "got", "an overlap");
  };
  for (std::size_t begin = 1; begin < 2 * kPairs; ++begin) {
    refused(kPairs, begin, kPairs);
  }
  // Where one has room for more than the other, too.
  refused(0, kPairs - 1, 2 * kPairs);
  EXPECT_EQ(room, Indices(3 * kPairs, 7));

  // Side by side.
  for (std::size_t begin : {std::size_t{0}, 2 * kPairs}) {
    EXPECT_EQ(pairs(all, kPairs, kPairs, begin, kPairs), kQueries * kObjects);
  }
  EXPECT_EQ(room, (Indices{0, 1, 2, 3, 0, 0, 0, 0, 0, 1, 2, 3}));

  room.assign(10, 7);
  EXPECT_EQ(pairs(all, 0, 8, 2, 2), kQueries * kObjects);
  EXPECT_EQ(room, (Indices{0, 0, 0, 1, 7, 7, 7, 7, 7, 7}));
  // What is too long by far is no error, though its bytes have no number.
  const AnyWorld two = World(2);
  EXPECT_EQ(pairs(two.Asked(Queries(1)), 4, kMost / 4, 6, kMost / 4), 2u);
  EXPECT_EQ(room, (Indices{0, 0, 0, 1, 0, 0, 0, 1, 7, 7}));
  // A range has the pairs of its objects.
  EXPECT_EQ(pairs(world.Asked(Queries(1)), 4, 4, 6, 4, {.range = {1, 3}}), 2u);
  EXPECT_EQ(room, (Indices{0, 0, 0, 1, 0, 0, 1, 2, 7, 7}));
  // Nothing survives in a world without objects.
  EXPECT_EQ(pairs(World(0).Asked(Queries()), 0, 8, 0, 8), 0u);
}

INSTANTIATE_TEST_SUITE_P(, RejectErrorsTest,
                         ::testing::ValuesIn(AllFlatCases()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace halfspace::testing
