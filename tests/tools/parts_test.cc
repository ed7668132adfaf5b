// Small parts of the tool, each against values by hand.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "bench/measure/load_probe.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/measure/team.h"
#include "bench/worlds/working_set.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

TEST(TeamTest, RunsEachThreadOnceAndRethrows) {
  std::vector<int> runs(3);
  const TeamTime time = RunTeam(3, [&](std::size_t i) { ++runs[i]; });
  EXPECT_EQ(runs, (std::vector<int>{1, 1, 1}));
  EXPECT_GT(time.seconds, 0.0);
  EXPECT_LE(time.cpu_share, 1.0);
  EXPECT_THROW(RunTeam(2,
                       [](std::size_t i) {
                         if (i == 1) throw std::runtime_error("over there");
                       }),
               std::runtime_error);
}

// Ratios of times of 0 were NaN, and were printed.
TEST(MeasureTest, RefusesATimeOfZero) {
  Case nothing;
  nothing.name = "nothing";
  nothing.items = std::numeric_limits<double>::infinity();
  nothing.run = [] {};
  Progress progress;
  EXPECT_THROW(Measure({nothing}, {.repetitions = 1}, progress),
               std::runtime_error);
}

// The ceilings of scans and builders: they must move every byte.
TEST(TargetLoopsTest, ReadsEveryByte) {
  constexpr std::size_t kFloats = 40 * kReadBytes / sizeof(float);
  for (std::size_t count : {4u, 6u, 8u}) {
    std::vector<std::vector<float>> planes(count,
                                           std::vector<float>(kFloats, 0));
    std::vector<const float*> list;
    for (const auto& plane : planes) list.push_back(plane.data());
    for (Target target : SupportedTargets()) {
      // By words, in turns that do not divide a plane, and by planes.
      for (std::size_t turn :
           {kReadBytes, 3 * kReadBytes, kFloats * sizeof(float)}) {
        SCOPED_TRACE(std::string(target.name()) + ", " + std::to_string(turn));
        const auto read = [&] {
          return LoopsFor(target).read(turn, list.data(), count,
                                       kFloats * sizeof(float));
        };
        EXPECT_EQ(read(), 0u);
        for (std::size_t p = 0; p < count; ++p) {
          // A float of each chunk, another one each time.
          for (std::size_t i = p; i < kFloats; i += kReadBytes / 4 - 1) {
            planes[p][i] = 1;
            EXPECT_NE(read(), 0u) << p << ", " << i;
            planes[p][i] = 0;
          }
        }
      }
    }
  }
}

TEST(TargetLoopsTest, CopiesEveryByte) {
  struct alignas(64) Lines {
    std::array<std::uint32_t, 3 * 64> words;
  };
  Lines from;
  std::iota(from.words.begin(), from.words.end(), 1u);
  for (Target target : SupportedTargets()) {
    for (bool streamed : {false, true}) {
      Lines to{};
      LoopsFor(target).copy(streamed, from.words.data(), to.words.data(), 128);
      for (std::size_t i = 0; i < to.words.size(); ++i) {
        EXPECT_EQ(to.words[i], i < 128 ? from.words[i] : 0) << target.name();
      }
    }
  }
}

// "This was a quiet run" was printed next to "other programs take 85 % of a
// CPU".
TEST(LoadTest, ARunNextToOtherProgramsIsNotQuiet) {
  struct Row {
    Load load;
    int cpus;
    bool is_loaded;
  };
  for (const Row& row : std::vector<Row>{{{1.0, 0.0, {}}, 2, false},
                                         {{0.99, 5.0, 0.1}, 2, false},
                                         {{1.0, 0.0, 0.85}, 2, true},
                                         {{1.0, 0.0, 0.85}, 16, false},
                                         {{0.6, 0.0, {}}, 16, true},
                                         {{0.97, 100.0, 0.0}, 2, true}}) {
    EXPECT_EQ(IsLoaded(row.load, row.cpus), row.is_loaded)
        << row.load.cpu_share << ' ' << row.load.interruptions << ' '
        << row.load.others.value_or(-1.0);
  }
  // A thread that waits has no CPU.
  const LoadProbe probe;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_LT(probe.Sample().cpu_share, 0.5);
}

TEST(PrintableTest, EscapesControlCharactersAndLeavesLetters) {
  EXPECT_EQ(Printable("a\n\x1b[31m\x7f"), "a\\x0a\\x1b[31m\\x7f");
  EXPECT_EQ(Printable("\xC3\x9F"), "\xC3\x9F");     // U+00DF
  EXPECT_EQ(Printable("\xC2\x9Bm"), "\xC2\\x9bm");  // U+009B
}

// A virtual machine that hides its caches had 32 MiB of "memory".
TEST(WorkingSetTest, MemoryIsMemoryOnAnyMachine) {
  constexpr std::size_t kMebibyte = std::size_t{1} << 20;
  struct Row {
    std::vector<Cache> caches;
    std::size_t bytes;  // of the simplex
  };
  for (const Row& row : std::vector<Row>{
           {{}, 256 * kMebibyte},
           {{{1, 32 << 10, 1}, {2, kMebibyte, 1}}, 256 * kMebibyte},
           {{{3, 32 * kMebibyte, 8}}, 256 * kMebibyte},
           {{{3, 96 * kMebibyte, 8}}, 384 * kMebibyte}}) {
    Machine machine;
    machine.caches = row.caches;
    const WorkingSetSize memory = WorkingSetSizes(machine).back();
    EXPECT_EQ(memory.name, "memory");
    EXPECT_EQ(memory.bytes, row.bytes);
    EXPECT_GE(memory.objects * 4 * sizeof(float), row.bytes);
  }
}

}  // namespace
}  // namespace halfspace::bench
