// Quantized bounds of any floats through any updates: alone they keep what the
// floats keep, refined they give the answer of the oracle, bit for bit, on any
// target, for one query and for many.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/quantized_followers.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/many_canaries.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

enum class Kind {
  kPush,
  kPushMany,
  kSet,
  kErase,
  kRequantize,
  kReserve,
  kClear
};
constexpr std::array kKindNames = {"push",       "push many", "set",  "erase",
                                   "requantize", "reserve",   "clear"};

struct Update {
  Kind kind = Kind::kPush;
  std::size_t index = 0;
  std::size_t object = 0;  // the number of the first bound that it brings
};

// A few words, or more objects than a byte tells apart.
std::size_t DecodeSize(Bytes& bytes) {
  const std::size_t size = bytes.Below(256);
  return size < 224 ? size : 224 + bytes.Below(256);
}

// One an input: most of what can be wrong is the same on all of them.
Target DecodeTarget(Bytes& bytes) {
  static const std::vector<Target> targets = TargetsUnderTest();
  return targets[bytes.Below(targets.size())];
}

template <typename Case>
class UpdatedQuantized {
 public:
  explicit UpdatedQuantized(Bytes& bytes)
      : mode_(bytes),
        size_(DecodeSize(bytes)),
        run_(std::size_t{1} << bytes.Below(8)),
        target_(DecodeTarget(bytes)),
        many_(bytes.Below(20)),
        updates_(bytes.Below(kMostUpdates + 1)) {
    for (Update& update : updates_) {
      update.kind = static_cast<Kind>(bytes.Below(kKindNames.size()));
      update.index = bytes.Below(1 << 16);
      update.object = bytes.Below(1 << 16);
    }
    for (std::size_t p = 0; p < kPlanes<FloatView>; ++p) {
      for (float& value : palettes_[p]) value = bytes.Float();
      const std::size_t step = bytes.Byte();
      steps_[p] = step < 128 ? 0 : std::uint32_t{1} << (step % 24);
      for (Query& query : queries_) {
        OpposingValue<FloatView>(query, p) = QueryValue(p, bytes.Byte());
      }
    }
    // Whose bits choose from the palettes, again and again.
    pattern_.assign(bytes.Rest().begin(), bytes.Rest().end());
    if (pattern_.empty()) pattern_.push_back(0x1b);
  }

  ::testing::AssertionResult Check() const {
    std::vector<Bound> bounds;
    for (std::size_t i = 0; i < size_; ++i) bounds.push_back(BoundAt(i));
    QuantizedFollowers<Case> followers{std::span<const Bound>(bounds)};
    for (std::size_t u = 0; u < updates_.size(); ++u) {
      mode_.Run([&] { Apply(updates_[u], followers); });
      auto result = CheckUpdated(followers);
      if (!result) return result << ", after update " << u;
    }
    return CheckAllCalls(followers);
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const UpdatedQuantized& input) {
    out << QuantizedCaseNames::GetName<Case>(0) << ", " << input.size_
        << " objects, runs of " << input.run_ << ", updated in the mode "
        << input.mode_ << ", asked on " << input.target_.name() << ", "
        << input.many_ << " queries at once\n";
    for (std::size_t p = 0; p < kPlanes<FloatView>; ++p) {
      out << "plane " << p << ": of " << Print(input.palettes_[p])
          << ", each object " << input.steps_[p] << " ulps from the last\n";
    }
    for (const Query& query : input.queries_) {
      out << "query " << Print(detail::Planes(query)) << '\n';
    }
    for (const Update& update : input.updates_) {
      out << kKindNames[static_cast<std::size_t>(update.kind)] << ", index "
          << update.index << ", object " << update.object << ": "
          << Print(detail::Planes(input.BoundAt(update.object))) << '\n';
    }
    return out;
  }

 private:
  using FloatView = typename Case::View;
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  static constexpr std::size_t kMostUpdates = 12;

  // In a plane of steps all objects differ.
  float Value(std::size_t p, std::size_t choice, std::size_t object) const {
    const auto bits = std::bit_cast<std::uint32_t>(palettes_[p][choice]);
    return std::bit_cast<float>(bits +
                                static_cast<std::uint32_t>(object) * steps_[p]);
  }

  Bound BoundAt(std::size_t object) const {
    Bound bound;
    for (std::size_t p = 0; p < kPlanes<FloatView>; ++p) {
      const std::size_t at = object / run_ * kPlanes<FloatView> + p;
      const std::uint8_t byte = pattern_[at / 4 % pattern_.size()];
      StoredValue<FloatView>(bound, p) =
          Value(p, byte >> (at % 4 * 2) & 3, object);
    }
    return bound;
  }

  // The value of an object, or a neighbour of it.
  float QueryValue(std::size_t p, std::uint8_t byte) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float value = Value(p, byte & 3, (byte >> 4) * size_ / 16);
    switch (byte >> 2 & 3) {
      case 2:
        return std::nextafter(value, kInfinity);
      case 3:
        return std::nextafter(value, -kInfinity);
      default:
        return value;
    }
  }

  void Apply(const Update& update, QuantizedFollowers<Case>& followers) const {
    const std::size_t size = followers.model().size();
    switch (update.kind) {
      case Kind::kPush:
        return followers.Push(BoundAt(update.object));
      case Kind::kPushMany:
        for (std::size_t i = 0; i < update.index % 100; ++i) {
          followers.Push(BoundAt(update.object + i));
        }
        return;
      case Kind::kSet:
        if (size == 0) return;
        return followers.Set(update.index % size, BoundAt(update.object));
      case Kind::kErase:
        if (size == 0) return;
        return followers.EraseBySwap(update.index % size);
      case Kind::kRequantize:
        return followers.Requantize();
      case Kind::kReserve:
        return followers.Reserve(update.index % 1000);
      case Kind::kClear:
        return followers.Clear();
    }
  }

  // By one call; what an update did wrong, all of them show.
  ::testing::AssertionResult CheckUpdated(
      const QuantizedFollowers<Case>& followers) const {
    const World<FloatView> floats(followers.model());
    for (const Query& query : queries_) {
      const Answer exact = ReferenceAnswer(floats.view(), query);
      const auto ask = [&](const auto& world) {
        return AnswerByMask(world, floats.size(), query, target_);
      };
      auto result = KeepsAllOf(exact, ask(followers.quantized()));
      if (!result) return result << " (quantized bounds)";
      result = KeepsAllOf(exact, ask(followers.quantized_world().quantized()));
      if (!result) return result << " (unrefined quantized world)";
      const Answer refined = ask(followers.quantized_world());
      if (!internal::Same(exact.reject_mask(), refined.reject_mask())) {
        return ::testing::AssertionFailure() << "wrong (quantized world)";
      }
    }
    return ::testing::AssertionSuccess();
  }

  ::testing::AssertionResult CheckAllCalls(
      const QuantizedFollowers<Case>& followers) const {
    const World<FloatView> floats(followers.model());
    const auto view = floats.view();
    const std::span<const Target> target(&target_, 1);
    auto result = QuantizedAnswersEverywhere(followers.quantized(), view,
                                             queries_.front(), target);
    if (!result) return result;
    std::vector<Query> many;
    for (std::size_t q = 0; q < many_; ++q) {
      many.push_back(queries_[q % queries_.size()]);
    }
    ManyAnswers answers;
    answers.AssignReference(view, many);
    result = AnswersManyEverywhere(answers, followers.quantized_world(), many,
                                   target);
    if (!result) return result << " (quantized world)";
    return result;
  }

  CallerMode mode_;
  std::size_t size_;
  std::size_t run_;  // objects in a row that choose the same
  Target target_;
  std::size_t many_;  // queries at once: those below, again and again
  std::array<Query, 3> queries_;
  std::vector<Update> updates_;
  std::array<std::array<float, 4>, kPlanes<FloatView>> palettes_;
  std::array<std::uint32_t, kPlanes<FloatView>> steps_;
  std::vector<std::uint8_t> pattern_;
};

template <typename... Cases>
::testing::Types<UpdatedQuantized<Cases>...> InputsOf(
    ::testing::Types<Cases...>);

}  // namespace

void RunInput(Bytes& bytes) {
  RunOneOf(decltype(InputsOf(QuantizedCases()))(), bytes);
}

}  // namespace halfspace::testing
