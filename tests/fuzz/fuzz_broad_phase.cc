// Histories of broad phases, of any floats, against a list of their bodies.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/broad_phase/history.h"

namespace halfspace::testing {
namespace {

// What a history does, by bytes. Each plane of a bound is one of four values,
// so a bound takes a byte or two.
template <typename View>
class BytesMaker {
 public:
  using Bound = typename View::Bound;
  using Palettes = std::array<std::array<float, 4>, kPlanes<View>>;

  BytesMaker(Bytes& bytes, const Palettes& palettes)
      : bytes_(bytes), palettes_(palettes) {}

  std::size_t Below(std::size_t end) { return bytes_.Below(end); }
  Bound Next() { return Moved(Bound{}, 0); }
  // On some of its planes.
  Bound Moved(const Bound& bound) { return Moved(bound, bytes_.Byte()); }
  BodyMasks Masks() {
    const std::uint8_t choice = bytes_.Byte();
    return {choice & 3u, choice >> 2 & 3u};
  }

 private:
  Bound Moved(Bound bound, std::uint32_t kept) {
    std::uint32_t choice = bytes_.Byte();
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      if (p == 4) choice = bytes_.Byte();
      if ((kept >> p & 1) == 0) {
        StoredValue<View>(bound, p) = palettes_[p][choice & 3];
      }
      choice >>= 2;
    }
    return bound;
  }

  Bytes& bytes_;
  const Palettes& palettes_;
};

template <typename View>
class BroadPhaseInput {
 public:
  static constexpr int kDims = View::Bound::kDimensions;

  explicit BroadPhaseInput(Bytes& bytes)
      : max_ids_(1 + bytes.Below(900)), has_filter_(bytes.Below(4) == 0) {
    for (auto& palette : palettes_) bytes.Fill(palette);
    margin_ = Finite(bytes.Float());
    pair_margin_ = Finite(bytes.Float());
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      OpposingValue<View>(query_, p) = bytes.Float();
    }
    bytes.Fill(box_.min);
    bytes.Fill(box_.max);
    bytes.Fill(direction_);
    max_t_ = std::abs(bytes.Float());
    if (std::isnan(max_t_)) max_t_ = 1;
    rest_.assign(bytes.Rest().begin(), bytes.Rest().end());
  }

  ::testing::AssertionResult Check() const {
    Bytes bytes(rest_.data(), rest_.size());
    BytesMaker<View> maker(bytes, palettes_);
    BroadPhaseOptions options;
    options.margin = margin_;
    if (has_filter_) options.filter.keep = &KeepsSome;
    BodyHistory<View, BytesMaker<View>> history(maker, max_ids_, options);
    for (std::size_t steps = 2 + bytes.Below(6); steps-- > 0;) {
      for (std::size_t changes = 1 + bytes.Below(6); changes-- > 0;) {
        history.Change();
      }
      ExpectIsModel(history.bodies(), history.model(), bytes.Byte());
      CheckQueries(history);
      if (bytes.Below(2) == 0) history.ExpectEvents();
      history.ExpectPairsOfSome(bytes.Below(100), pair_margin_);
      // The failed expectation has said why.
      if (::testing::Test::HasFailure()) return ::testing::AssertionFailure();
    }
    return ::testing::AssertionSuccess();
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const BroadPhaseInput& input) {
    out << kPlanes<View> << " planes, " << input.max_ids_ << " ids\n";
    auto query = input.query_;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      out << "plane " << p << ": query "
          << Print(std::array{OpposingValue<View>(query, p)}) << ", of "
          << Print(input.palettes_[p]) << '\n';
    }
    return out << "margins "
               << Print(std::array{input.margin_, input.pair_margin_})
               << ", cast of " << Print(input.box_.min) << " to "
               << Print(input.box_.max) << " by " << Print(input.direction_)
               << " up to " << Print(std::array{input.max_t_}) << '\n';
  }

 private:
  static float Finite(float value) {
    return std::isfinite(value) ? std::abs(value) : 0;
  }

  // Those of any floats.
  template <typename History>
  void CheckQueries(const History& history) const {
    constexpr std::uint64_t kMask = 1;
    const auto& bodies = history.bodies();
    const auto& model = history.model();
    const auto masked = model.Found(kMask);
    ExpectFindsSame(bodies, model, masked, query_, kMask);
    ExpectFindsSame(bodies, model, masked, box_.min, kMask);
    ExpectCastsSame(
        model, masked,
        [&](const auto& function) {
          bodies.ForEachCast(box_, direction_, max_t_, kMask, function);
        },
        [&](const Bvh<View>& bvh, const auto& function) {
          BoxCast(bvh, box_, direction_, max_t_, function);
        });
    const Ray<kDims> ray{box_.max, direction_, max_t_};
    ExpectCastsSame(
        model, masked,
        [&](const auto& function) { bodies.ForEachCast(ray, kMask, function); },
        [&](const Bvh<View>& bvh, const auto& function) {
          RayCast(bvh, ray, function);
        });
  }

  std::size_t max_ids_;
  bool has_filter_;
  typename BytesMaker<View>::Palettes palettes_;
  float margin_;
  float pair_margin_;
  typename View::Query query_;
  Aabb<kDims> box_;
  Point<kDims> direction_;
  float max_t_;
  std::vector<std::uint8_t> rest_;
};

}  // namespace

void RunInput(Bytes& bytes) {
  using Inputs =
      ::testing::Types<BroadPhaseInput<AabbView2>, BroadPhaseInput<AabbView3>,
                       BroadPhaseInput<AaboView2>, BroadPhaseInput<AaboView3>>;
  RunOneOf(Inputs(), bytes);
}

}  // namespace halfspace::testing
