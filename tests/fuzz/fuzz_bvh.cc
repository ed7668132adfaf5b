// BVHs of any floats, after any changes, against scans of a list of
// their objects; and altered blobs, of which calls may read nothing else.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <ostream>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/reject.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/bvh/separated.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

template <typename View>
class BvhHistory {
 public:
  explicit BvhHistory(Bytes& bytes)
      : size_(bytes.Below(700)), is_blob_(bytes.Below(8) == 0) {
    for (auto& palette : palettes_) bytes.Fill(palette);
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      OpposingValue<View>(query_, p) = bytes.Float();
    }
    rest_.assign(bytes.Rest().begin(), bytes.Rest().end());
  }

  ::testing::AssertionResult Check() const {
    Bytes bytes(rest_.data(), rest_.size());
    std::vector<Bound> bounds;
    for (std::size_t i = 0; i < size_; ++i) bounds.push_back(Next(bytes));
    Bvh<View> world(bounds,
                    {.quality = bytes.Below(2) == 0 ? BuildQuality::kHigh
                                                    : BuildQuality::kFast});
    if (is_blob_) {
      // With empty places and free ids, or without.
      for (std::size_t i = bytes.Below(4) * bytes.Below(100); i-- > 0;) {
        const auto id = static_cast<std::uint32_t>(bytes.Below(700));
        if (world.Has(id)) {
          world.Erase(id);
        } else {
          world.Insert(Next(bytes));
        }
      }
      return CheckBlob(world, bytes);
    }
    Model model(bounds.begin(), bounds.end());
    for (int step = 0; step < 4; ++step) {
      for (std::size_t i = bytes.Below(100); i-- > 0;) {
        const auto result = Change(bytes, world, model);
        if (!result) return result;
      }
      if (bytes.Below(4) == 0) world.RebuildPartial(bytes.Below(700));
      if (bytes.Below(8) == 0) world.Rebuild({.quality = BuildQuality::kFast});
      auto result = CheckObjects(world, model);
      if (result) result = CheckAnswers(world, model);
      if constexpr (HasMaxima<View>) {
        if (result) result = CheckPairs(world, model);
      }
      if (!result) return result;
    }
    return ::testing::AssertionSuccess();
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const BvhHistory& history) {
    out << kPlanes<View> << " planes, " << history.size_ << " objects\n";
    auto query = history.query_;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      out << "plane " << p << ": query "
          << Print(std::array{OpposingValue<View>(query, p)}) << ", of "
          << Print(history.palettes_[p]) << '\n';
    }
    return out;
  }

 private:
  using Bound = typename View::Bound;
  // What changes may pass, too: only a Bvh of boxes takes doubles.
  using Other = std::conditional_t<detail::kIsOfBoxes<View>,
                                   detail::DoubleBound<View>, Bound>;
  using Model = std::vector<std::optional<Bound>>;  // by id

  // A value of each palette; all ends at once are a bound of few bytes.
  Bound Next(Bytes& bytes) const {
    Bound bound{};
    std::uint32_t choice = bytes.Byte();
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      if (p == 4) choice = bytes.Byte();
      StoredValue<View>(bound, p) = palettes_[p][choice & 3];
      choice >>= 2;
    }
    return bound;
  }

  // Changes both, by one object or by a list, of floats or of the same doubles.
  ::testing::AssertionResult Change(Bytes& bytes, Bvh<View>& world,
                                    Model& model) const {
    const std::size_t what = bytes.Below(13);
    const std::size_t at =
        model.empty() ? 0 : bytes.Below(1 << 16) % model.size();
    const auto id = static_cast<std::uint32_t>(at);
    if (what == 12) return AddAList(bytes, world, model);
    if (what >= 9) return ChangeAList(bytes, world, model);
    if (what == 8) return ReserveOrClear(bytes, world, model);
    if (what < 3 || model.empty() || !model[at]) {
      const Bound bound = Next(bytes);
      return Add(
          what == 0 ? world.Insert(InDoubles(bound)) : world.Insert(bound),
          bound, model);
    }
    if (what == 3) {
      world.Erase(id);
      model[at].reset();
    } else {
      model[at] = Next(bytes);
      if (what == 4) {
        world.Set(id, InDoubles(*model[at]));
      } else {
        world.Set(id, *model[at]);
      }
    }
    return ::testing::AssertionSuccess();
  }

  static ::testing::AssertionResult Add(std::uint32_t id, const Bound& bound,
                                        Model& model) {
    if (id >= model.size()) model.resize(id + 1u);
    if (model[id]) {
      return ::testing::AssertionFailure() << "id " << id << " is in use";
    }
    model[id] = bound;
    return ::testing::AssertionSuccess();
  }

  ::testing::AssertionResult ChangeAList(Bytes& bytes, Bvh<View>& world,
                                         Model& model) const {
    const std::size_t what = bytes.Below(3);
    const bool is_of_doubles = bytes.Below(4) == 0;
    const bool may_miss = bytes.Below(16) == 0;  // ids, which are refused then
    std::vector<Bound> bounds(bytes.Below(bytes.Below(16) == 1 ? 600 : 12));
    std::vector<Other> doubles;
    std::vector<std::uint32_t> ids;
    bool are_all_there = true;
    for (Bound& bound : bounds) {
      bound = Next(bytes);
      doubles.push_back(InDoubles(bound));
      ids.push_back(static_cast<std::uint32_t>(bytes.Below(1 << 16) %
                                               (model.size() + 1)));
      for (std::size_t i = 0; i < model.size() && !may_miss; ++i) {
        if (Has(model, ids.back())) break;
        ids.back() =
            (ids.back() + 1u) % static_cast<std::uint32_t>(model.size());
      }
      are_all_there &= Has(model, ids.back());
    }
    try {
      if (what == 0) {
        if (is_of_doubles) {
          world.Insert(doubles, ids);
        } else {
          world.Insert(bounds, ids);
        }
        for (std::size_t i = 0; i < ids.size(); ++i) {
          const auto result = Add(ids[i], bounds[i], model);
          if (!result) return result;
        }
        return ::testing::AssertionSuccess();
      }
      if (what == 1) {
        world.Erase(ids);
      } else if (is_of_doubles) {
        world.Set(ids, doubles);
      } else {
        world.Set(ids, bounds);
      }
    } catch (const std::invalid_argument&) {
      if (!are_all_there) return ::testing::AssertionSuccess();
      throw;
    }
    if (!are_all_there) {
      return ::testing::AssertionFailure() << "a list with a missing id";
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (what == 1) {
        model[ids[i]].reset();
      } else {
        model[ids[i]] = bounds[i];
      }
    }
    return ::testing::AssertionSuccess();
  }

  // Under ids that are given, some of which may be in use or come twice.
  ::testing::AssertionResult AddAList(Bytes& bytes, Bvh<View>& world,
                                      Model& model) const {
    const std::size_t most = model.size() + (bytes.Below(8) == 0 ? 9000 : 300);
    const bool may_be_wrong = bytes.Below(8) == 0;
    Model added = model;
    std::vector<Bound> bounds;
    std::vector<std::uint32_t> ids;
    bool are_all_free = true;
    for (std::size_t i = bytes.Below(40); i-- > 0;) {
      const auto id = static_cast<std::uint32_t>(bytes.Below(1 << 16) % most);
      if (Has(added, id)) {
        if (!may_be_wrong) continue;
        are_all_free = false;
      }
      bounds.push_back(Next(bytes));
      ids.push_back(id);
      if (!Has(added, id)) Add(id, bounds.back(), added);
    }
    try {
      world.InsertAs(ids, bounds);
    } catch (const std::invalid_argument&) {
      if (!are_all_free) return ::testing::AssertionSuccess();
      throw;
    }
    if (!are_all_free) {
      return ::testing::AssertionFailure() << "a list with an id in use";
    }
    model = std::move(added);
    return ::testing::AssertionSuccess();
  }

  ::testing::AssertionResult ReserveOrClear(Bytes& bytes, Bvh<View>& world,
                                            Model& model) const {
    if (bytes.Below(16) == 0) {
      world.Clear();
      model.clear();
    }
    const std::size_t more = bytes.Below(200);
    world.Reserve(world.size() + more);
    const std::size_t room = world.bytes();
    for (std::size_t i = bytes.Below(200); i < more; ++i) {
      const Bound bound = Next(bytes);
      const auto result = Add(world.Insert(bound), bound, model);
      if (!result) return result;
    }
    if (world.bytes() != room) {
      return ::testing::AssertionFailure() << "reserved too little";
    }
    return ::testing::AssertionSuccess();
  }

  static bool Has(const Model& model, std::size_t id) {
    return id < model.size() && model[id].has_value();
  }

  static Other InDoubles(const Bound& bound) {
    const auto floats = detail::Planes(bound);
    detail::PlaneValues<Other> doubles;
    std::copy(floats.begin(), floats.end(), doubles.begin());
    return detail::BoundOf<Other>(doubles);
  }

  // The bound of each object, and that of all.
  ::testing::AssertionResult CheckObjects(const Bvh<View>& world,
                                          const Model& model) const {
    std::size_t size = 0;
    Bound all = Bound::Empty();
    for (std::uint32_t id = 0; id < model.size() + 3; ++id) {
      if (world.Has(id) != Has(model, id)) {
        return ::testing::AssertionFailure() << "Has(" << id << ")";
      }
      if (!Has(model, id)) continue;
      ++size;
      Bound bound = world.Get(id);
      Bound expected = *model[id];
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        const float v = StoredValue<View>(expected, p);
        const float got = StoredValue<View>(bound, p);
        if (got != v && (got == got || v == v)) {
          return ::testing::AssertionFailure() << "Get(" << id << ")";
        }
        const float sign = IsMinPlane<View>(p) ? 1.0f : -1.0f;
        float& outermost = StoredValue<View>(all, p);
        if (!(sign * outermost <= sign * v)) {
          outermost =
              v == v ? v : -sign * std::numeric_limits<float>::infinity();
        }
      }
    }
    if (world.size() != size || world.Bounds() != all) {
      return ::testing::AssertionFailure() << size << " objects, or Bounds()";
    }
    return ::testing::AssertionSuccess();
  }

  ::testing::AssertionResult CheckAnswers(const Bvh<View>& world,
                                          const Model& model) const {
    World<View> flat;
    std::vector<std::uint32_t> ids;
    for (std::size_t id = 0; id < model.size(); ++id) {
      if (!model[id]) continue;
      flat.Push(*model[id]);
      ids.push_back(static_cast<std::uint32_t>(id));
    }
    for (const auto& query : {query_, View::Query::Everything()}) {
      std::vector<bool> expected(model.size());
      std::vector<std::uint32_t> kept(flat.size());
      const std::size_t count = Survivors(flat, query, kept);
      for (std::size_t i = 0; i < count; ++i) expected[ids[kept[i]]] = true;
      for (Target target : TargetsUnderTest()) {
        std::vector<std::uint32_t> found(world.size());
        std::vector<bool> marked(model.size());
        const std::size_t survivors =
            Survivors(world, query, found, {.target = target});
        if (survivors == count) {
          for (std::size_t i = 0; i < count; ++i) marked.at(found[i]) = true;
        }
        if (marked != expected ||
            CountSurvivors(world, query, {.target = target}) != count) {
          return ::testing::AssertionFailure()
                 << target.name() << ": " << survivors << " of " << count;
        }
      }
    }
    return CheckCasts(world, model);
  }

  // The same on all targets; and what the box overlaps is touched at once, and
  // 0 away.
  ::testing::AssertionResult CheckCasts(
      const Bvh<View>& world,
      const std::vector<std::optional<Bound>>& model) const {
    constexpr int kDims = Bound::kDimensions;
    Aabb<kDims> box;
    Point<kDims> direction;
    bool is_finite = true;
    for (std::size_t k = 0; k < kDims; ++k) {
      box.min[k] = palettes_[k][0];
      box.max[k] = palettes_[k][1];
      direction[k] = palettes_[k][2];
      is_finite = is_finite && std::abs(box.min[k]) < 0x1p90f &&
                  std::abs(box.max[k]) < 0x1p90f && box.min[k] <= box.max[k];
    }
    const float max_t =
        palettes_[0][3] == palettes_[0][3] ? std::abs(palettes_[0][3]) : 0.0f;
    std::vector<std::pair<std::uint32_t, float>> expected;
    std::vector<std::uint32_t> expected_nearest;
    for (Target target : TargetsUnderTest()) {
      const SearchOptions options = {.target = target};
      std::vector<std::pair<std::uint32_t, float>> found;
      BoxCast(
          world, box, direction, max_t,
          [&](std::uint32_t id, float t) { found.emplace_back(id, t); },
          options);
      std::vector<std::uint32_t> nearest(world.size() + 1);
      std::vector<float> distances(nearest.size());
      KNearestOfEach(world, Span<const Aabb<kDims>>(&box, 1), nearest.size(),
                     nearest, distances, std::numeric_limits<float>::infinity(),
                     options);
      if (target == TargetsUnderTest().front()) {
        expected = found;
        expected_nearest = nearest;
      }
      if (found != expected || nearest != expected_nearest) {
        return ::testing::AssertionFailure()
               << target.name() << ": another cast, or other distances";
      }
      std::vector<bool> at_once(model.size());
      for (const auto& [id, t] : found) at_once.at(id) = t == 0;
      std::vector<bool> touching(model.size());
      for (std::size_t i = 0; i < world.size(); ++i) {
        if (nearest[i] != kNoId) touching.at(nearest[i]) = distances[i] == 0;
      }
      for (std::size_t id = 0; id < model.size() && is_finite; ++id) {
        if (model[id] && Overlaps(*model[id], box) &&
            !(at_once[id] && touching[id])) {
          return ::testing::AssertionFailure()
                 << target.name() << ": " << id << " touches the box";
        }
      }
    }
    return ::testing::AssertionSuccess();
  }

  // The pairs of a set of some ids, a third of which want no others.
  ::testing::AssertionResult CheckPairs(
      const Bvh<View>& world,
      const std::vector<std::optional<Bound>>& model) const {
    using PairList = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    auto query = query_;
    const float size = std::fabs(OpposingValue<View>(query, 0));
    std::vector<std::uint32_t> set;
    std::vector<std::uint32_t> wanted;
    const auto wants = [&](std::size_t id) {
      return id % 32 == 5 && id % 3 != 0;
    };
    for (std::uint32_t id = 5; id < model.size(); id += 32) {
      if (!model[id]) continue;
      set.push_back(id);
      wanted.push_back(wants(id) ? 1 : 0);
    }
    for (float margin : {0.0f, std::isfinite(size) ? size : 1.0f}) {
      std::optional<PairList> first;
      for (Target target : TargetsUnderTest()) {
        const PairOptions options{
            .wanted = wanted, .margin = margin, .target = target};
        std::vector<IdPair> pairs(PairsOf(world, set, {}, options));
        bool is_right = PairsOf(world, set, pairs, options) == pairs.size();
        PairList found;
        for (const auto& [a, b] : pairs) {
          found.emplace_back(a, b);
          if (wants(b) && b < a)
            std::swap(found.back().first, found.back().second);
        }
        std::sort(found.begin(), found.end());
        if (first) {
          is_right &= found == *first;
        } else {
          first = found;
          auto next = found.begin();
          for (std::uint32_t a : set) {
            for (std::uint32_t b = 0; b < model.size() && wants(a); ++b) {
              if (!model[b] || (wants(b) && b <= a)) continue;
              const bool is_found =
                  next != found.end() && *next == std::pair(a, b);
              if (is_found) ++next;
              is_right &= AreSeparated(*model[a], *model[b], margin,
                                       is_found ? 0x1p-21 : 0) == !is_found;
            }
          }
          is_right &= next == found.end();
        }
        if (!is_right) {
          return ::testing::AssertionFailure()
                 << target.name() << ": " << pairs.size()
                 << " pairs with margin " << margin;
        }
      }
    }
    return ::testing::AssertionSuccess();
  }

  // On all axes but D, and on D by all that it can have.
  static bool Overlaps(Bound bound, const Aabb<Bound::kDimensions>& box) {
    double least = 0;
    double most = 0;
    for (std::size_t k = 0; k < box.min.size(); ++k) {
      least -= box.max[k];
      most -= box.min[k];
    }
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      const std::size_t k = p % Bound::kAxes;
      const double plane = StoredValue<View>(bound, p);
      const bool is_d = k == box.min.size();
      if (IsMinPlane<View>(p) ? plane > (is_d ? most : box.max[k])
                              : plane < (is_d ? least : box.min[k])) {
        return false;
      }
    }
    return true;
  }

  // Nothing to compare: a sanitizer sees what is read.
  ::testing::AssertionResult CheckBlob(const Bvh<View>& world,
                                       Bytes& bytes) const {
    const auto blob = world.Blob();
    const std::unique_ptr<std::byte, Free> memory(static_cast<std::byte*>(
        ::operator new (blob.size() + 1, std::align_val_t{64})));
    const std::span<std::byte> altered(memory.get(), blob.size());
    std::copy(blob.begin(), blob.end(), altered.begin());
    for (std::size_t i = bytes.Below(20); i-- > 0 && !altered.empty();) {
      const std::size_t at =
          bytes.Below(2) == 0 ? bytes.Below(64) : bytes.Below(1 << 16);
      altered[at % altered.size()] = static_cast<std::byte>(bytes.Byte());
    }
    try {
      auto loaded = bytes.Below(2) == 0 ? Bvh<View>::InPlace(altered)
                                        : Bvh<View>::FromBlob(altered);
      Query(loaded, bytes);
      for (std::size_t i = bytes.Below(200); i-- > 0;) {
        try {
          ChangeAltered(loaded, bytes);
        } catch (const std::invalid_argument&) {
          // Refused.
        }
        if (bytes.Below(8) == 0) Query(loaded, bytes);
      }
    } catch (const std::invalid_argument&) {
      // Refused.
    }
    return ::testing::AssertionSuccess();
  }

  void Query(const Bvh<View>& world, Bytes& bytes) const {
    constexpr int kDims = Bound::kDimensions;
    std::vector<std::uint32_t> ids(bytes.Below(100));
    for (Target target : TargetsUnderTest()) {
      (void)Survivors(world, query_, ids, {.target = target});
      (void)CountSurvivors(world, View::Query::Everything(),
                           {.mask = 5, .target = target});
      (void)CountSurvivors(world, Segment<kDims>{{}, {}}, {.target = target});
      (void)KNearest(world, Point<kDims>{}, ids, {}, 1e9f, {.target = target});
      Point<kDims> direction{};
      direction[0] = 1;
      RayCast(world, Ray<kDims>{{}, direction, 1e9f},
              [](std::uint32_t, float) {}, {.target = target});
      if constexpr (HasMaxima<View>) {
        (void)Pairs(world, {}, {.target = target});
        std::vector<std::uint32_t> set;
        for (std::uint32_t id = 0; id < 700; id += 7) {
          if (world.Has(id)) set.push_back(id);
        }
        (void)PairsOf(world, set, {}, {.margin = 1, .target = target});
        (void)PairsOf(world, set, world, {}, {.wanted = set, .target = target});
      }
    }
    (void)world.Bounds();
    (void)world.CostRatio();
    (void)world.Verify();
    (void)world.Blob();
  }

  void ChangeAltered(Bvh<View>& world, Bytes& bytes) const {
    const auto id = static_cast<std::uint32_t>(bytes.Below(700));
    switch (bytes.Below(16)) {
      case 10:
        (void)world.Get(id);
        return;
      case 11:
        return bytes.Below(16) == 0 ? world.Clear() : world.Reserve(id);
      case 12:
        return world.Erase(std::vector<std::uint32_t>{id, id / 2});
      case 13:
        return world.Set(std::vector<std::uint32_t>{id, id / 2},
                         std::vector<Bound>(2, Next(bytes)));
      case 14: {
        std::vector<std::uint32_t> ids(id % 16);
        return world.Insert(std::vector<Bound>(ids.size(), Next(bytes)), ids);
      }
      case 0:
        return world.Erase(id);
      case 1:
        return world.Set(id, Next(bytes));
      case 2:
        return world.SetMasks(id, 1);
      case 3:
        return world.SetMasks(std::vector<std::uint32_t>(1500, 5));
      case 4:
        world.RebuildPartial(bytes.Below(9000));
        return;
      case 5:
        return world.Rebuild();
      case 6:
        return world.Refit(std::vector<Bound>(1500, Next(bytes)));
      case 7:
        return world.RefitInOrder(
            std::vector<Bound>(world.ids().size(), Next(bytes)));
      default:
        world.Insert(Next(bytes));
    }
  }

  struct Free {
    void operator()(std::byte* memory) const {
      ::operator delete (memory, std::align_val_t{64});
    }
  };

  std::size_t size_;
  bool is_blob_;
  std::array<std::array<float, 4>, kPlanes<View>> palettes_;
  typename View::Query query_;
  std::vector<std::uint8_t> rest_;
};

}  // namespace

void RunInput(Bytes& bytes) {
  using Histories =
      ::testing::Types<BvhHistory<SimplexView2>, BvhHistory<SimplexView3>,
                       BvhHistory<AabbView2>, BvhHistory<AabbView3>,
                       BvhHistory<AaboView2>, BvhHistory<AaboView3>>;
  RunOneOf(Histories(), bytes);
}

}  // namespace halfspace::testing
