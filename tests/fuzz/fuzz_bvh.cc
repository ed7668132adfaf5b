// Histories of BVHs of any floats, against lists of their objects; and altered
// blobs, of which calls may read nothing else.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/history_input.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/bvh/aligned_copy.h"

namespace halfspace::testing {
namespace {

class BvhInput : public HistoryInput {
 public:
  explicit BvhInput(Bytes& bytes) : HistoryInput(LayoutsOf(false), bytes) {}

  ::testing::AssertionResult Check() const {
    Bytes bytes(rest_.data(), rest_.size());
    ByteChoices choices(layout_, palettes_, bytes);
    BvhHistory history(layout_, choices, bytes.Below(most_), most_,
                       kFpModes[how_ % 6]);
    for (std::size_t steps = 2 + bytes.Below(4); steps-- > 0;) {
      for (std::size_t changes = 1 + bytes.Below(20); changes-- > 0;) {
        history.Change();
      }
      Random random(bytes.Byte());
      history.ExpectIsModel({.shapes = 1}, random);
      ExpectAnswersOf(history.bvh(), history.objects(), bytes);
      // The failed expectation has said why.
      if (::testing::Test::HasFailure()) return ::testing::AssertionFailure();
    }
    LoadAltered(history.bvh(), choices, bytes);
    return ::testing::AssertionSuccess();
  }

 private:
  // Nothing to compare: a sanitizer sees what is read.
  void LoadAltered(const AnyBvh& bvh, ByteChoices& choices,
                   Bytes& bytes) const {
    const AlignedCopy blob(bvh.tree().Blob());
    const auto altered = blob.bytes();
    for (std::size_t i = bytes.Below(20); i-- > 0 && !altered.empty();) {
      const std::size_t at =
          bytes.Below(2) == 0 ? bytes.Below(64) : bytes.Word();
      altered[at % altered.size()] = static_cast<std::byte>(bytes.Byte());
    }
    try {
      const auto loaded = bvh.Copy()->Loaded(altered, bytes.Below(2) == 0, {});
      Query(*loaded);
      for (std::size_t i = bytes.Below(200); i-- > 0;) {
        try {
          Change(*loaded, choices);
        } catch (const std::invalid_argument&) {
          // Refused.
        }
        if (bytes.Below(8) == 0) Query(*loaded);
      }
    } catch (const std::invalid_argument&) {
      // Refused.
    }
  }

  void Query(const AnyBvh& world) const {
    Ids ids(100);
    const Planes everything = AllPlanes(layout_, kMost);
    const Shape all{Shape::kBound, {everything.begin(), everything.end()}};
    const Shape segment{Shape::kSegment, std::vector<float>(2 * layout_.dims)};
    for (Target target : TargetsUnderTest()) {
      (void)world.Find(query_, ids, {.target = target}, 0);
      (void)world.Count(all, {.mask = 5, .target = target});
      (void)world.Count(segment, {.target = target});
      (void)world.Nearest({.is_point = true}, ids, {}, 1e9f,
                          {.target = target});
      Motion ray;
      ray.place.is_point = true;
      ray.direction[0] = 1;
      ray.max_t = 1e9f;
      world.Cast(
          ray, [](std::uint32_t, float, const Planes&) { return Limit{kInf}; },
          {.target = target});
      if (!layout_.has_max) continue;
      (void)world.FindPairs(nullptr, nullptr, {}, {.target = target});
      Ids some;
      for (std::uint32_t id = 0; id < 700; id += 7) {
        if (world.tree().Has(id)) some.push_back(id);
      }
      const Span<const std::uint32_t> set = some;
      (void)world.FindPairs(nullptr, &set, {}, {.margin = 1, .target = target});
      (void)world.FindPairs(&world, &set, {},
                            {.wanted = set, .target = target});
    }
    (void)world.Bounds();
    (void)world.tree().CostRatio();
    (void)world.tree().Verify();
    (void)world.tree().Blob();
  }

  static void Change(AnyBvh& world, ByteChoices& choices) {
    const auto id = static_cast<std::uint32_t>(choices.Below(700));
    const BoundList one{{choices.Next()}, {}};
    const auto several = [&](std::size_t count) {
      return BoundList{std::vector<Planes>(count, one.floats[0]), {}};
    };
    switch (choices.Below(16)) {
      case 0:
        return world.EraseOne(id);
      case 1:
        return world.SetOne(id, one);
      case 2:
        return world.SetMask(id, 1);
      case 3:
        return world.SetMasks(Ids(1500, 5));
      case 4:
        world.RebuildPartial(choices.Below(9000));
        return;
      case 5:
        return world.Rebuild({});
      case 6:
        return world.Refit(several(1500));
      case 7:
        return world.RefitInOrder(several(world.tree().ids().size()));
      case 8:
        (void)world.Get(id);
        return;
      case 9:
        return choices.Below(16) == 0 ? world.Clear() : world.Reserve(id);
      case 10:
        return world.Erase(Ids{id, id / 2});
      case 11:
        return world.Set(Ids{id, id / 2}, several(2));
      case 12: {
        Ids ids(id % 16);
        return world.Insert(several(ids.size()), ids);
      }
      case 13:
        return world.InsertAs(Ids{id, id / 2 + 3000}, several(2));
      default:
        (void)world.InsertOne(one);
    }
  }
};

}  // namespace

void RunInput(Bytes& bytes) { Run<BvhInput>(bytes); }

}  // namespace halfspace::testing
