// Worlds of any floats and doubles: every target and every call against the
// oracle, bit for bit.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "halfspace/reject.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

const std::vector<FlatCase>& Rows() {
  static const std::vector<FlatCase> rows = AllFlatCases();
  return rows;
}

// Sizes of a few words, and around the tiles of staged scans.
std::size_t DecodeSize(Bytes& bytes) {
  const std::size_t size = bytes.Below(256);
  if (size < 224) return size;
  if (size < 248) return 224 + bytes.Below(256);
  return (size < 254 ? 1 : 2) * 4096 - 64 + bytes.Below(256);
}

class World {
 public:
  explicit World(Bytes& bytes)
      : row_(Rows()[bytes.Below(Rows().size())]),
        size_(DecodeSize(bytes)),
        schedule_(kSchedules[bytes.Below(kSchedules.size())]),
        offset_(bytes.Below(kOffsets)),
        capacity_(bytes.Below(size_ + 70)),
        run_(std::size_t{1} << bytes.Below(8)) {
    row_.WithScalar([&]<typename T>(T) { Decode<T>(bytes); });
  }

  ::testing::AssertionResult Check() const {
    const AnyWorld world = row_.world(pointers_, size_);
    const AnyQueries query(query_.data(), 1);
    const Answers answers = Answers::OfReference(world, query);
    auto result = AnswersEverywhere(answers, world, query, TargetsUnderTest(),
                                    {&schedule_, 1});
    for (Target target : TargetsUnderTest()) {
      if (!result) break;
      result = CheckShortList(answers, world, query,
                              {.schedule = schedule_, .target = target});
    }
    return result;
  }

  friend std::ostream& operator<<(std::ostream& out, const World& world) {
    out << world.row_ << ", " << world.size_ << " objects, schedule "
        << static_cast<int>(world.schedule_) << ", offset " << world.offset_
        << ", room for " << world.capacity_ << " indices, runs of "
        << world.run_ << '\n';
    for (std::size_t p = 0; p < world.palettes_.size(); ++p) {
      out << "plane " << p
          << ": the value of the query, then those of objects: "
          << Print(world.palettes_[p]) << '\n';
    }
    return out << "pattern " << Print(world.pattern_) << '\n';
  }

 private:
  static constexpr std::size_t kOffsets = 16;

  template <typename T>
  void Decode(Bytes& bytes) {
    std::array<T, 10> query{};
    for (std::size_t p = 0; p < row_.stored.plane_count; ++p) {
      std::array<T, 5> palette;
      bytes.Fill(palette);
      query[OpposingValue(row_.stored, p)] = palette[0];
      palettes_.emplace_back(palette.begin(), palette.end());
    }
    row_.see_query(query.data(), query_.data());
    // Whose bits choose from the palettes, again and again.
    pattern_.assign(bytes.Rest().begin(), bytes.Rest().end());
    if (pattern_.empty()) pattern_.push_back(0x1b);
    for (std::size_t p = 0; p < row_.stored.plane_count; ++p) {
      // No two planes in a row share an alignment, and each ends where its
      // block does.
      const std::size_t offset = (offset_ + 3 * p) % kOffsets;
      blocks_.emplace_back((offset + size_) * sizeof(T));
      T* const values = reinterpret_cast<T*>(blocks_.back().data()) + offset;
      for (std::size_t i = 0; i < size_; ++i) {
        const std::size_t at = i / run_ * row_.stored.plane_count + p;
        const std::uint8_t byte = pattern_[at / 4 % pattern_.size()];
        values[i] =
            static_cast<T>(palettes_[p][1 + (byte >> (at % 4 * 2) & 3u)]);
      }
      pointers_[p] = values;
    }
  }

  ::testing::AssertionResult CheckShortList(const Answers& answers,
                                            const AnyWorld& world,
                                            const AnyQueries& query,
                                            const Options& options) const {
    const auto all = answers.survivors();
    const auto expected = all.first(std::min(capacity_, all.size()));
    Canaried<std::uint32_t> indices;
    const auto out = indices.Reset(capacity_);
    Differences compare(options);
    compare.Find("Survivors", all.size(),
                 detail::Survivors(world.Asked(query), out, options, 0));
    compare.Find<std::uint32_t>("Survivors", expected, out);
    if (!indices.IntactBut(expected.size())) {
      compare.Add("Survivors", "wrote past the last survivor");
    }
    return compare.first();
  }

  const FlatCase& row_;
  std::size_t size_;
  Schedule schedule_;
  std::size_t offset_;
  std::size_t capacity_;
  std::size_t run_;  // objects in a row that are the same
  alignas(double) std::array<std::byte, 80> query_{};
  std::vector<std::vector<double>> palettes_;
  std::vector<std::uint8_t> pattern_;
  std::vector<std::vector<std::byte>> blocks_;
  PlanePointers pointers_{};
};

}  // namespace

void RunInput(Bytes& bytes) { Run<World>(bytes); }

}  // namespace halfspace::testing
