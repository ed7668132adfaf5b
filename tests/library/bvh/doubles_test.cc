// BVHs of boxes of doubles: the same as those of the rounded floats, and no
// overlap of the doubles is missed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

template <typename View>
using InDouble = detail::DoubleView<View>;

template <typename View>
InDouble<View> ViewOf(const Input<InDouble<View>>& input) {
  return ViewAt(input, 0, input.planes[0].size(), 1);
}

template <typename View>
std::vector<typename InDouble<View>::Bound> ListOf(const InDouble<View>& view) {
  std::vector<typename InDouble<View>::Bound> bounds;
  for (std::size_t i = 0; i < view.size; ++i) {
    bounds.push_back(detail::BoundAt(view, i));
  }
  return bounds;
}

template <typename Bound>
auto Rounded(const std::vector<Bound>& bounds) {
  std::vector<decltype(RoundOutward(bounds[0]))> rounded;
  for (const Bound& bound : bounds) rounded.push_back(RoundOutward(bound));
  return rounded;
}

template <typename View>
bool AreSame(const Bvh<View>& a, const Bvh<View>& b) {
  const auto of_a = a.Blob();
  const auto of_b = b.Blob();
  return std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end());
}

template <typename Case>
class BvhDoublesTest : public ::testing::Test {};
using BoxCases = Tested<::testing::Types<Whole<AabbView2>, Whole<AabbView3>>>;
TYPED_TEST_SUITE(BvhDoublesTest, BoxCases, CaseNames);

// Among them objects that touch the query, and miss it by an ulp of double.
TYPED_TEST(BvhDoublesTest, MissesNoOverlapOfTheDoubles) {
  using View = typename TypeParam::View;
  Random random(3);
  for (InputKind kind : kInputKinds) {
    for (std::size_t round = 0; round < 3 + Scaled(20); ++round) {
      const auto input =
          MakeInput<InDouble<View>>(kind, 1 + random() % 700, random);
      const InDouble<View> view = ViewOf<View>(input);
      Ids expected(view.size);
      expected.resize(Survivors(view, input.query, expected));
      const Bvh<View> bvh(view);
      const auto query = RoundOutward(input.query);
      for (Target target : TargetsUnderTest()) {
        Ids found(bvh.size());
        found.resize(Survivors(bvh, query, found, {.target = target}));
        found = InOrder(found);
        EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(),
                                  expected.end()))
            << NameOf(kind) << ", " << target.name();
      }
    }
  }
}

TYPED_TEST(BvhDoublesTest, AreBuiltAsTheirFloatsInEveryMode) {
  using View = typename TypeParam::View;
  Random random(5);
  for (std::size_t size : {std::size_t{0}, std::size_t{9}, std::size_t{9000}}) {
    const auto input =
        MakeInput<InDouble<View>>(InputKind::kAdversarial, size, random);
    const InDouble<View> view = ViewOf<View>(input);
    const auto list = ListOf<View>(view);
    for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
      const BuildOptions options = {.quality = quality};
      const Bvh<View> expected(Rounded(list), options);
      for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        const RoundingMode rounding(mode);
        EXPECT_TRUE(AreSame(Bvh<View>(view, options), expected));
      }
      {
        const FlushDenormals flush;
        EXPECT_TRUE(AreSame(Bvh<View>(list, options), expected));
      }
      const World<InDouble<View>> world(list);
      EXPECT_TRUE(AreSame(Bvh<View>(world, options), expected));
    }
  }
}

TYPED_TEST(BvhDoublesTest, AreChangedAsTheirFloatsInEveryMode) {
  using View = typename TypeParam::View;
  Random random(11);
  const auto more = [&](std::size_t size) {
    return ListOf<View>(ViewOf<View>(
        MakeInput<InDouble<View>>(InputKind::kAdversarial, size, random)));
  };
  for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    const auto bounds = more(5000);
    Bvh<View> bvh(bounds);
    Bvh<View> floats(Rounded(bounds));
    const auto change = [&](const auto& of_doubles, const auto& of_floats) {
      {
        const RoundingMode rounding(mode);
        of_doubles();
      }
      of_floats();
      EXPECT_TRUE(AreSame(bvh, floats));
    };
    const auto one = more(1);
    change([&] { bvh.Set(7, one[0]); },
           [&] { floats.Set(7, RoundOutward(one[0])); });
    change([&] { bvh.Insert(one[0]); },
           [&] { floats.Insert(RoundOutward(one[0])); });
    const auto some = more(300);
    Ids ids(300);
    Ids same(300);
    change([&] { bvh.Insert(some, ids); },
           [&] { floats.Insert(Rounded(some), same); });
    EXPECT_EQ(ids, same);
    const auto others = more(300);
    change([&] { bvh.Set(ids, others); },
           [&] { floats.Set(ids, Rounded(others)); });
    const auto two = more(2);
    const Ids own = {5400, 5350};
    change([&] { bvh.InsertAs(own, two); },
           [&] { floats.InsertAs(own, Rounded(two)); });
    // With empty places, and without.
    for (bool has_gaps : {false, true}) {
      if (has_gaps) {
        change([&] { bvh.Erase(ids); }, [&] { floats.Erase(ids); });
      }
      const auto by_id = more(bvh.id_limit());
      change([&] { bvh.Refit(by_id); }, [&] { floats.Refit(Rounded(by_id)); });
      const auto in_order = more(bvh.ids().size());
      change([&] { bvh.RefitInOrder(in_order); },
             [&] { floats.RefitInOrder(Rounded(in_order)); });
    }
  }
}

// Records with other data between them.
template <typename Scalar>
struct Body {
  Scalar mass;
  Aabb<3, Scalar> box;
};

template <typename Scalar>
Boxes<3, Scalar> BoxesIn(const std::vector<Body<Scalar>>& bodies) {
  Boxes<3, Scalar> boxes;
  boxes.count = bodies.size();
  boxes.stride = sizeof(Body<Scalar>) / sizeof(Scalar);
  for (std::size_t k = 0; k < 3; ++k) {
    boxes.min[k] = &bodies[0].box.min[k];
    boxes.max[k] = &bodies[0].box.max[k];
  }
  return boxes;
}

TEST(BvhBoxesTest, AreReadInPlace) {
  Random random(13);
  const auto bounds = ListOf<AabbView3>(ViewOf<AabbView3>(
      MakeInput<AabbView<3, double>>(InputKind::kMixed, 5000, random)));
  const std::vector<Aabb3> rounded = Rounded(bounds);
  std::vector<Body<double>> bodies;
  std::vector<Body<float>> of_floats;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    bodies.push_back({1.0, bounds[i]});
    of_floats.push_back({1.0f, rounded[i]});
  }
  const AabbBvh3 expected(rounded);
  AabbBvh3 of_boxes(BoxesIn(bodies));
  AabbBvh3 of_float_boxes(BoxesIn(of_floats));
  EXPECT_TRUE(AreSame(of_boxes, expected));
  EXPECT_TRUE(AreSame(of_float_boxes, expected));
  std::rotate(bodies.begin(), bodies.begin() + 99, bodies.end());
  std::rotate(of_floats.begin(), of_floats.begin() + 99, of_floats.end());
  of_boxes.Refit(BoxesIn(bodies));
  of_float_boxes.Refit(BoxesIn(of_floats));
  EXPECT_FALSE(AreSame(of_boxes, expected));
  EXPECT_TRUE(AreSame(of_boxes, of_float_boxes));
}

TEST(BvhDoublesErrorsTest, RefusesWhatItCannotRead) {
  using List = Span<const Aabb<3, double>>;
  const std::vector<Aabb<3, double>> three(3, Aabb<3, double>::Everything());
  AabbBvh3 bvh(three);
  const AabbBvh3 before = bvh;
  Ids ids = {0, 1, 2};
  const auto refused = [&](std::string_view call, const auto& made) {
    EXPECT_TRUE(Refuses([&] { made(List(nullptr, 3)); },
                        {call, "bounds: ", "got a null pointer"}));
    EXPECT_TRUE(
        Refuses([&] { made(List(Misaligned(three.data()), 3)); },
                {call, "bounds: ", "aligned to 8", "got a misaligned one"}));
  };
  refused("Bvh: ", [&](List list) { AabbBvh3 bad(list); });
  refused("Bvh::Refit: ", [&](List list) { bvh.Refit(list); });
  refused("Bvh::RefitInOrder: ", [&](List list) { bvh.RefitInOrder(list); });
  refused("Bvh::Set: ", [&](List list) { bvh.Set(ids, list); });
  refused("Bvh::Insert: ", [&](List list) { bvh.Insert(list, ids); });
  const List two(three.data(), 2);
  EXPECT_TRUE(Refuses([&] { bvh.Refit(two); }, {"Refit", "3", "2"}));
  EXPECT_TRUE(Refuses([&] { bvh.Set(ids, two); }, {"Set", "3", "2"}));
  EXPECT_TRUE(Refuses([&] { bvh.Set(9, three[0]); }, {"Set", "id", "9"}));
  Ids one(1);
  EXPECT_TRUE(Refuses([&] { bvh.Insert(two, one); }, {"Insert", "ids", "2"}));
  EXPECT_TRUE(Refuses([&] { AabbBvh3 bad(two, {.quality = BuildQuality{2}}); },
                      {"Bvh: ", "quality"}));
  Boxes<3, double> boxes = BoxesOf(three);
  boxes.stride = std::numeric_limits<std::size_t>::max() / 8;
  EXPECT_TRUE(
      Refuses([&] { AabbBvh3 bad(boxes); }, {"Bvh: ", "bounds.stride"}));
  AabbView<3, double> view;
  view.size = 3;
  EXPECT_TRUE(Refuses([&] { AabbBvh3 bad(view); },
                      {"Bvh: ", "world.min[0]", "3 elements", "null"}));
  EXPECT_TRUE(AreSame(bvh, before));
}

}  // namespace
}  // namespace halfspace::testing
