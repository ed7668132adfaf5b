// Histories of broad phases, of any floats, against Bvhs of their bodies, and
// saved bytes that were altered.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

#include "halfspace/error.h"
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
      : most_bodies_(1 + bytes.Below(900)), how_(bytes.Byte()) {
    for (auto& palette : palettes_) bytes.Fill(palette);
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
    options.moves_wait_for_update = how_ % 2 != 0;
    options.caller_locks = how_ / 2 % 2 != 0;
    if (how_ / 4 % 4 == 0) options.filter.keep = &KeepsSome;
    constexpr std::uint32_t kStrides[] = {1, 3, 700, 5000};
    BodyHistory<View, BytesMaker<View>> history(
        maker, most_bodies_, kStrides[how_ / 16 % 4], options,
        how_ / 64 % 2 == 0 ? FpMode::kDefault : FpMode::kTraps);
    for (std::size_t steps = 2 + bytes.Below(6); steps-- > 0;) {
      for (std::size_t changes = 1 + bytes.Below(6); changes-- > 0;) {
        history.Change();
      }
      history.ExpectIsModel(bytes.Byte());
      CheckQueries(history);
      // The failed expectation has said why.
      if (::testing::Test::HasFailure()) return ::testing::AssertionFailure();
    }
    LoadAltered(history.bodies(), bytes);
    return ::testing::AssertionSuccess();
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const BroadPhaseInput& input) {
    out << kPlanes<View> << " planes, " << input.most_bodies_ << " bodies\n";
    auto query = input.query_;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      out << "plane " << p << ": query "
          << Print(std::array{OpposingValue<View>(query, p)}) << ", of "
          << Print(input.palettes_[p]) << '\n';
    }
    return out << "cast of " << Print(input.box_.min) << " to "
               << Print(input.box_.max) << " by " << Print(input.direction_)
               << " up to " << Print(std::array{input.max_t_}) << '\n';
  }

 private:
  // Those of any floats.
  template <typename History>
  void CheckQueries(const History& history) const {
    const auto& bodies = history.bodies();
    const Reference<View> reference = history.model().Seen();
    const auto expect = [&](const auto& ask) {
      ExpectAnswer(bodies, reference, ask);
    };
    QueryOptions options;
    options.mask = 1;
    SearchOptions search;
    search.mask = 1;
    expect([&](const auto& world, const auto& names) {
      return FoundBy(world, names, query_, options);
    });
    expect([&](const auto& world, const auto& names) {
      return FoundBy(world, names, box_.min, options);
    });
    expect([&](const auto& world, const auto& names) {
      return HitBy<View>(names, [&](const auto& function) {
        BoxCast(world, box_, direction_, max_t_, function, search);
      });
    });
    const Ray<kDims> ray{box_.max, direction_, max_t_};
    expect([&](const auto& world, const auto& names) {
      return HitBy<View>(names, [&](const auto& function) {
        RayCast(world, ray, function, search);
      });
    });
  }

  // Altered bytes are refused, or do no harm.
  static void LoadAltered(const BroadPhase<View>& bodies, Bytes& bytes) {
    std::vector<std::byte> saved = BytesOf(bodies);
    for (std::size_t n = bytes.Below(4); n-- > 0;) {
      const std::size_t at = bytes.Word() % saved.size();
      saved[at] = static_cast<std::byte>(bytes.Byte());
    }
    BroadPhase<View> loaded;
    try {
      loaded.Load(saved);
    } catch (const Error&) {
      return;
    }
    Ids ids(loaded.size());
    const std::size_t found = Survivors(loaded, View::Query::Everything(), ids);
    ids.resize(std::min(found, ids.size()));
    (void)loaded.Validate();
    loaded.UpdatePairs();
    loaded.Rebuild();
    if (std::all_of(ids.begin(), ids.end(),
                    [&](std::uint32_t id) { return loaded.Has(id); })) {
      loaded.Erase(ids);
    }
  }

  std::size_t most_bodies_;
  std::uint8_t how_;  // options
  typename BytesMaker<View>::Palettes palettes_;
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
