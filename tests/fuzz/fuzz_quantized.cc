// Histories of quantized bounds and worlds of any floats: alone they keep what
// the floats keep, refined they give the answer of the oracle, bit for bit, on
// any target, for one query and for many.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <ostream>
#include <span>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/owners.h"

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

const std::vector<OwnerRow>& Rows() {
  static const std::vector<OwnerRow> rows = [] {
    std::vector<OwnerRow> all = OwnerRows();
    std::erase_if(all, [](const OwnerRow& row) { return !row.IsQuantized(); });
    return all;
  }();
  return rows;
}

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

class UpdatedQuantized {
 public:
  explicit UpdatedQuantized(Bytes& bytes)
      : row_(Rows()[bytes.Below(Rows().size())]),
        mode_(kFpModes[bytes.Below(5)]),
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
    for (std::size_t p = 0; p < planes_; ++p) {
      bytes.Fill(palettes_[p]);
      const std::size_t step = bytes.Byte();
      steps_[p] = step < 128 ? 0 : std::uint32_t{1} << (step % 24);
      for (std::size_t q = 0; q < kQueries; ++q) {
        queries_[q * planes_ + OpposingValue(row_.layout, p)] =
            QueryValue(p, bytes.Byte());
      }
    }
    // At once: those queries, again and again.
    for (std::size_t i = kQueries * planes_; i < queries_.size(); ++i) {
      queries_[i] = queries_[i - kQueries * planes_];
    }
    // Whose bits choose from the palettes, again and again.
    pattern_.assign(bytes.Rest().begin(), bytes.Rest().end());
    if (pattern_.empty()) pattern_.push_back(0x1b);
  }

  ::testing::AssertionResult Check() const {
    Records model;
    for (std::size_t i = 0; i < size_; ++i) model.push_back(BoundAt(i));
    const auto owner = row_.Make(model);
    for (std::size_t u = 0; u < updates_.size(); ++u) {
      RunIn(mode_, [&] { Apply(updates_[u], *owner, model); });
      if (owner->size() != model.size()) {
        return ::testing::AssertionFailure()
               << "a wrong size, after update " << u;
      }
      auto result = CheckUpdated(*owner, model);
      if (!result) return result << ", after update " << u;
    }
    return CheckAllCalls(*owner, model);
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const UpdatedQuantized& input) {
    out << input.row_ << ", " << input.size_ << " objects, runs of "
        << input.run_ << ", updated in the mode "
        << static_cast<int>(input.mode_) << ", asked on "
        << input.target_.name() << ", " << input.many_ << " queries at once\n";
    for (std::size_t p = 0; p < input.planes_; ++p) {
      out << "plane " << p << ": of " << Print(input.palettes_[p])
          << ", each object " << input.steps_[p] << " ulps from the last\n";
    }
    out << "queries " << Print(input.queries_) << '\n';
    for (const Update& update : input.updates_) {
      out << kKindNames[static_cast<std::size_t>(update.kind)] << ", index "
          << update.index << ", object " << update.object << '\n';
    }
    return out;
  }

 private:
  static constexpr std::size_t kMostUpdates = 12;
  static constexpr std::size_t kQueries = 3;

  // In a plane of steps all objects differ.
  float Value(std::size_t p, std::size_t choice, std::size_t object) const {
    const auto bits = std::bit_cast<std::uint32_t>(palettes_[p][choice]);
    return std::bit_cast<float>(bits +
                                static_cast<std::uint32_t>(object) * steps_[p]);
  }

  Record BoundAt(std::size_t object) const {
    Record bound{};
    for (std::size_t p = 0; p < planes_; ++p) {
      const std::size_t at = object / run_ * planes_ + p;
      const std::uint8_t byte = pattern_[at / 4 % pattern_.size()];
      const float value = Value(p, byte >> (at % 4 * 2) & 3, object);
      std::memcpy(&bound[p * sizeof(float)], &value, sizeof(float));
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

  void Apply(const Update& update, AnyOwner& owner, Records& model) const {
    const auto push = [&](const Record& bound) {
      owner.Push(bound);
      model.push_back(bound);
    };
    switch (update.kind) {
      case Kind::kPush:
        return push(BoundAt(update.object));
      case Kind::kPushMany:
        for (std::size_t i = 0; i < update.index % 100; ++i) {
          push(BoundAt(update.object + i));
        }
        return;
      case Kind::kSet: {
        if (model.empty()) return;
        Record& bound = model[update.index % model.size()];
        bound = BoundAt(update.object);
        return owner.Set(update.index % model.size(), bound);
      }
      case Kind::kErase:
        if (model.empty()) return;
        owner.EraseBySwap(update.index % model.size());
        model[update.index % model.size()] = model.back();
        return model.pop_back();
      case Kind::kRequantize:
        return owner.Requantize(*row_.MakeFloats(model));
      case Kind::kReserve:
        return owner.Reserve(update.index % 1000);
      case Kind::kClear:
        model.clear();
        return owner.Clear();
    }
  }

  // By one call; what an update did wrong, all of them show.
  ::testing::AssertionResult CheckUpdated(const AnyOwner& owner,
                                          const Records& model) const {
    const auto floats = row_.MakeFloats(model);
    const AnyQueries queries(queries_.data(), kQueries);
    const Answers exact = Answers::OfReference(floats->seen(), queries);
    auto result =
        KeepsAllOf(exact, Answers::OfCall(owner.quantized(), queries, target_));
    if (!result) return result;
    const Answers refined =
        Answers::OfCall(owner.Refined(*floats), queries, target_);
    if (std::ranges::equal(exact.rejected(), refined.rejected())) return result;
    return ::testing::AssertionFailure() << "wrong (refined)";
  }

  ::testing::AssertionResult CheckAllCalls(const AnyOwner& owner,
                                           const Records& model) const {
    const auto floats = row_.MakeFloats(model);
    for (std::size_t count : {std::size_t{1}, many_}) {
      const AnyQueries queries(queries_.data(), count);
      const auto result = QuantizedAnswersEverywhere(
          owner.quantized(), owner.Refined(*floats),
          Answers::OfReference(floats->seen(), queries), queries,
          {&target_, 1});
      if (!result) return result;
    }
    return ::testing::AssertionSuccess();
  }

  const OwnerRow& row_;
  const std::size_t planes_ = row_.layout.plane_count;
  FpMode mode_;
  std::size_t size_;
  std::size_t run_;  // objects in a row that choose the same
  Target target_;
  std::size_t many_;  // queries at once
  std::vector<float> queries_ =
      std::vector<float>((kQueries + many_) * planes_);
  std::vector<Update> updates_;
  std::array<std::array<float, 4>, 10> palettes_{};
  std::array<std::uint32_t, 10> steps_{};
  std::vector<std::uint8_t> pattern_;
};

}  // namespace

void RunInput(Bytes& bytes) { Run<UpdatedQuantized>(bytes); }

}  // namespace halfspace::testing
