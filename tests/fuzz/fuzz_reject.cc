// Worlds of any floats and doubles: every target and every call against the
// oracle, bit for bit.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <ostream>
#include <span>
#include <vector>

#include "halfspace/reject.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// `size` numbers, the first of them `offset` elements after a 64-byte boundary
// and the last at the very end of its block.
template <typename T>
class MisalignedPlane {
 public:
  MisalignedPlane(std::size_t offset, std::size_t size)
      : block_(static_cast<T*>(
            ::operator new((offset + size) * sizeof(T), kAlignment))),
        values_(block_.get() + offset, size) {}

  std::span<T> values() const { return values_; }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(T* block) const { ::operator delete(block, kAlignment); }
  };

  std::unique_ptr<T, Free> block_;
  std::span<T> values_;
};

// Sizes of a few words, and around the tiles of staged scans.
std::size_t DecodeSize(Bytes& bytes) {
  const std::size_t size = bytes.Below(256);
  if (size < 224) return size;
  if (size < 248) return 224 + bytes.Below(256);
  return (size < 254 ? 1 : 2) * 4096 - 64 + bytes.Below(256);
}

template <typename Case>
class World {
 public:
  explicit World(Bytes& bytes)
      : size_(DecodeSize(bytes)),
        schedule_(kSchedules[bytes.Below(kSchedules.size())]),
        offset_(bytes.Below(kOffsets)),
        capacity_(bytes.Below(size_ + 70)),
        run_(std::size_t{1} << bytes.Below(8)) {
    for (std::size_t p = 0; p < kPlanes<Stored>; ++p) {
      OpposingValue<Stored>(query_, p) = bytes.Number<Scalar>();
      bytes.Fill(palettes_[p]);
    }
    // Whose bits choose from the palettes, again and again.
    pattern_.assign(bytes.Rest().begin(), bytes.Rest().end());
    if (pattern_.empty()) pattern_.push_back(0x1b);
    for (std::size_t p = 0; p < kPlanes<Stored>; ++p) MakePlane(p);
    stored_.size = size_;
  }

  ::testing::AssertionResult Check() const {
    const auto view = Case::Seen(stored_);
    const auto query = Case::Seen(query_);
    const Answer answer = ReferenceAnswer(view, query);
    CanariedOutputs outputs;
    for (Target target : TargetsUnderTest()) {
      const Options options{.schedule = schedule_, .target = target};
      auto result = Answers(answer, view, query, options, outputs.For(answer));
      if (!result) return result;
      if (!outputs.Intact()) {
        return internal::Fail("a call", options) << "wrote past its output";
      }
      result = CheckShortList(answer, view, query, options);
      if (!result) return result;
    }
    return ::testing::AssertionSuccess();
  }

  friend std::ostream& operator<<(std::ostream& out, const World& world) {
    out << NameOf(Case()) << ", " << world.size_ << " objects, schedule "
        << static_cast<int>(world.schedule_) << ", offset " << world.offset_
        << ", room for " << world.capacity_ << " indices, runs of "
        << world.run_ << '\n';
    auto query = world.query_;
    for (std::size_t p = 0; p < kPlanes<Stored>; ++p) {
      const auto values = world.planes_[p].values();
      out << "plane " << p << ": query "
          << Print(std::array{OpposingValue<Stored>(query, p)}) << ", of "
          << Print(world.palettes_[p]) << ", first elements "
          << Print(values.first(std::min<std::size_t>(world.size_, 70)))
          << '\n';
    }
    return out;
  }

 private:
  using Stored = typename Case::Stored;
  using Scalar = ScalarOf<Stored>;
  static constexpr std::size_t kOffsets = 16;

  void MakePlane(std::size_t p) {
    // No two planes in a row share an alignment.
    planes_.emplace_back((offset_ + 3 * p) % kOffsets, size_);
    const auto values = planes_.back().values();
    for (std::size_t i = 0; i < size_; ++i) {
      const std::size_t at = i / run_ * kPlanes<Stored> + p;
      const std::uint8_t byte = pattern_[at / 4 % pattern_.size()];
      values[i] = palettes_[p][byte >> (at % 4 * 2) & 3];
    }
    PlaneOf(stored_, p) = values.data();
  }

  template <typename View>
  ::testing::AssertionResult CheckShortList(const Answer& answer,
                                            const View& view,
                                            const typename View::Query& query,
                                            const Options& options) const {
    const auto all = answer.survivors();
    const auto expected = all.first(std::min(capacity_, all.size()));
    Canaried<std::uint32_t> indices;
    const auto out = indices.Reset(capacity_);
    const std::size_t counted = Survivors(view, query, out, options);
    if (counted != all.size()) {
      return internal::Fail("Survivors", options)
             << "expected " << all.size() << ", got " << counted;
    }
    if (!internal::Same<std::uint32_t>(expected, out)) {
      return internal::FailElement<std::uint32_t>("Survivors", options,
                                                  expected, out);
    }
    if (!indices.IntactBut(expected.size())) {
      return internal::Fail("Survivors", options)
             << "wrote past the last survivor";
    }
    return ::testing::AssertionSuccess();
  }

  std::size_t size_;
  Schedule schedule_;
  std::size_t offset_;
  std::size_t capacity_;
  std::size_t run_;  // objects in a row that are the same
  typename Stored::Query query_;
  std::array<std::array<Scalar, 4>, kPlanes<Stored>> palettes_;
  std::vector<std::uint8_t> pattern_;
  std::vector<MisalignedPlane<Scalar>> planes_;
  Stored stored_;
};

template <typename... Cases>
::testing::Types<World<Cases>...> WorldsOf(::testing::Types<Cases...>);

}  // namespace

void RunInput(Bytes& bytes) {
  RunOneOf(decltype(WorldsOf(AllCases()))(), bytes);
}

}  // namespace halfspace::testing
