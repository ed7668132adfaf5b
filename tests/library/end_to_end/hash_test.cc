// Constants that stand for many answers: the same on every target, compiler and
// machine. The other tests compare what runs here with what runs here; only
// constants compare with machines that are elsewhere.
//
// hashes.txt has them, a name and a hash in each line. If answers are meant to
// change, run hash_test with HALFSPACE_UPDATE_HASHES=1 after all other tests
// passed. It writes the new hashes, and those of new names.
// HALFSPACE_TEST_SCALE does not count.
//
// Flat scans, on machines that run no other test of them, are compared with the
// oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <ios>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

// One number that stands for many: FNV-1a, 64 bits, over bytes whose order is
// that of the values and not of the machine's memory.
class FnvHash {
 public:
  void Add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ ^= (value >> (8 * byte)) & 0xff;
      hash_ *= 0x100000001b3u;
    }
  }

  // Both zeros count as one: they compare alike, and which of them a sum or a
  // minimum gives is nobody's promise.
  void AddFloat(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    Add(bits == 0x80000000u ? 0 : bits);
  }

  template <typename Range>
  void AddAll(const Range& values) {
    for (const auto value : values) Add(value);
  }

  template <typename Range>
  void AddAllFloats(const Range& values) {
    for (const float value : values) AddFloat(value);
  }

  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

::testing::AssertionResult IsKnown(const std::string& name,
                                   std::uint64_t hash) {
  static std::map<std::string, std::uint64_t> known = [] {
    std::map<std::string, std::uint64_t> read;
    std::ifstream file(HALFSPACE_TEST_HASHES);
    std::string its_name;
    std::uint64_t its_hash;
    while (file >> its_name >> std::hex >> its_hash) read[its_name] = its_hash;
    return read;
  }();
  const auto it = known.find(name);
  if (it != known.end() && it->second == hash) {
    return ::testing::AssertionSuccess();
  }
  if (std::getenv("HALFSPACE_UPDATE_HASHES") != nullptr) {
    known[name] = hash;
    std::ofstream file(HALFSPACE_TEST_HASHES);
    for (const auto& [its_name, its_hash] : known) {
      file << its_name << ' ' << std::hex << its_hash << '\n';
    }
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure()
         << "the hash of " << name << " is " << std::hex << hash;
}

// Scans on machines that run no other test of them: flat ones against the
// oracle, and one constant for the answers of each kind of quantized bounds.

constexpr std::size_t kQueries = 32;

class FlatScanTargetsTest : public ::testing::TestWithParam<FlatCase> {};

TEST_P(FlatScanTargetsTest, AnswersAreThoseOfTheOracle) {
  // A tile of a staged scan, then words, then a tail.
  constexpr std::size_t kObjects = 4096 + 3 * 64 + 37;
  const std::vector<Target> targets = TargetsUnderTest();
  Random random(1);
  for (InputKind kind : {InputKind::kMixed, InputKind::kAdversarial}) {
    const FlatInput input(GetParam(), kind, kObjects, random);
    const FlatQueries queries(GetParam(), input, kQueries, random);
    const AnyWorld world = input.WorldAt(0, kObjects, 1);
    for (std::size_t count : {std::size_t{1}, kQueries}) {
      const AnyQueries some = queries.Some(0, count);
      const Answers answers = Answers::OfReference(world, some);
      EXPECT_GT(answers.survivors().size(), 0u);
      EXPECT_TRUE(AnswersEverywhere(answers, world, some, targets))
          << NameOf(kind) << ", " << count << " queries";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, FlatScanTargetsTest,
                         ::testing::ValuesIn(AllFlatCases()),
                         ::testing::PrintToStringParamName());

class QuantizedHashTest : public ::testing::TestWithParam<QuantizedRow> {};

// Of quantized bounds that are not refined. These are not the answers of the
// floats, but the map is integer arithmetic on the bits of floats, in every
// floating-point mode.
TEST_P(QuantizedHashTest, IsTheSameEverywhere) {
  // More than a map is trained from, for one byte.
  constexpr std::size_t kObjects = (1 << 16) + 3 * 64 + 37;
  const std::size_t planes = GetParam().planes();
  SeededNumbers numbers(GetParam().layout.dims);
  std::vector<float> values(kObjects * planes);
  for (float& value : values) value = numbers.Coordinate();
  // Values of the objects, of which most survive.
  std::vector<float> queries(kQueries * planes);
  for (std::size_t q = 0; q < kQueries; ++q) {
    for (std::size_t p = 0; p < planes; ++p) {
      const float value = values[numbers.Below(kObjects) * planes + p];
      const float loose = GetParam().IsMinPlane(p) ? 64.f : -64.f;
      queries[q * planes + OpposingValue(GetParam().layout, p)] =
          numbers.Below(3) == 0 ? value : loose;
    }
  }
  const AnyQueries asked(queries.data(), kQueries);
  const AnyQuantized made = GetParam().Make(values);
  const Answers exact = Answers::OfReference(made.floats(), asked);
  const std::vector<Target> targets = TargetsUnderTest();
  for (std::size_t i = 0; i < std::max<std::size_t>(6, targets.size()); ++i) {
    const FpMode mode = kFpModes[i % 6];
    const Target target = targets[i % targets.size()];
    AnyQuantized all;
    Answers found;
    RunIn(mode, [&] {
      all = GetParam().Make(values);
      found = Answers::OfCall(all.quantized(), asked, target);
    });
    EXPECT_GT(found.survivors().size(), exact.survivors().size());
    EXPECT_GT(exact.survivors().size(), kObjects);
    EXPECT_LT(found.survivors().size(), kObjects * kQueries);
    FnvHash hash;
    hash.AddAll(found.survived());
    EXPECT_TRUE(IsKnown(GetParam().name, hash.value()))
        << target.name() << ", mode " << static_cast<int>(mode);
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedHashTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         ::testing::PrintToStringParamName());

// One constant per call and dimensions that stands for the bounds of many
// seeded shapes by all its builders, in all floating-point modes of the caller.
TEST(BoundHashTest, IsTheSameEverywhere) {
  constexpr int kBounds = 1000;
  std::map<std::string, FnvHash> hashes;
  for (const Builder& builder : BuildersAndChanges()) {
    FnvHash& hash =
        hashes[std::string(builder.call) + std::to_string(builder.dims)];
    SeededNumbers numbers(11);
    int unbounded = 0;
    for (int i = 0; i < kBounds; ++i) {
      const Shape shape = SeededShape(builder, numbers);
      Planes planes;
      RunIn(kFpModes[i % 6], [&] { planes = builder.Build(shape); });
      unbounded += planes == builder.Everything();
      for (float plane : planes) ASSERT_FALSE(std::isnan(plane)) << i;
      hash.AddAllFloats(planes);
    }
    EXPECT_LT(unbounded, kBounds / 2) << builder.name;
  }
  for (const auto& [name, hash] : hashes) {
    EXPECT_TRUE(IsKnown(name, hash.value()));
  }
}

// The same for the builders of many bounds, in every layout.

constexpr std::size_t kShapes = 5 * 64 + 37;

// Some boxes are inverted, some spheres have no radius.
BulkShapes SeededShapes(const Bulk& bulk) {
  SeededNumbers numbers(bulk.dims);
  BulkShapes shapes(kShapes);
  for (auto& shape : shapes) {
    const Builder& single = bulk.single();
    const Shape seeded = SeededShape(single, numbers);
    for (std::size_t i = 0; i < single.roles.size(); ++i) {
      shape.push_back(single.Number(seeded, i));
    }
    const std::uint32_t kind = numbers.Below(32);
    if (bulk.kind == Kind::kPoints) shape.resize(kind % 4 * bulk.dims);
    if (kind == 0 && !bulk.IsOfPoints()) std::swap(shape[0], shape.back());
  }
  return shapes;
}

TEST(BulkHashTest, IsTheSameEverywhere) {
  std::map<std::string, FnvHash> hashes;
  std::size_t mode = 0;
  for (const Bulk& bulk : Bulks()) {
    BulkSource source(bulk, SeededShapes(bulk));
    for (Inverted inverted : {Inverted::kEverything, Inverted::kEmpty}) {
      std::set<std::uint64_t> all;
      for (BulkLayout layout : kBulkLayouts) {
        Arena arena;
        source.Place(arena, layout);
        const BulkOutput built(bulk, kShapes, arena);
        for (Target target : TargetsUnderTest()) {
          FitOptions options;
          options.inverted = inverted;
          options.target = target;
          FitStatus status;
          RunIn(kFpModes[mode++ % 6],
                [&] { source.Bound(built.output(), options, &status); });
          FnvHash hash;
          for (std::size_t i = 0; i < kShapes; ++i) {
            hash.AddAllFloats(built.Get(i));
          }
          hash.Add(status.results);
          hash.Add(status.everything);
          hash.Add(status.first_everything);
          EXPECT_LT(status.everything, status.results / 4);
          all.insert(hash.value());
          EXPECT_EQ(all.size(), 1u) << bulk.name << ", " << target.name()
                                    << ", layout " << static_cast<int>(layout);
        }
      }
      hashes[bulk.name.substr(0, bulk.name.find_first_of("234") + 1)].AddAll(
          all);
    }
  }
  for (const auto& [name, hash] : hashes) {
    EXPECT_TRUE(IsKnown(name, hash.value()));
  }
}

// One seeded history per bound type, and two constants for all its answers: the
// same on every target, compiler, standard library and machine. The first is of
// the answers in ascending order. The second is of the answers as they came,
// and changes with the tree's arrangement. Changes run on the target of the
// process.

template <typename View>
void ExpectKnownAnswers(Target target) {
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  constexpr std::size_t kBodies = 6000;  // with three levels of nodes
  FnvHash sorted;
  FnvHash order;
  // Of one call: hashes of its answers.
  std::vector<std::uint64_t> answers;
  const auto add = [&](Span<const std::uint32_t> ids) {
    answers.insert(answers.end(), ids.begin(), ids.end());
  };
  const auto add_hit = [&](std::uint32_t id, float t, const Bound& bound) {
    FnvHash hash;
    hash.Add(id);
    hash.AddFloat(t);
    hash.AddAllFloats(bound.min);
    hash.AddAllFloats(bound.max);
    answers.push_back(hash.value());
  };
  const auto add_pairs = [&](Span<const IdPair> pairs) {
    for (const IdPair& pair : pairs) {
      const auto [a, b] = std::minmax(pair.a, pair.b);
      answers.push_back(std::uint64_t{a} << 32 | b);
    }
  };
  const auto end_call = [&] {
    order.AddAll(answers);
    std::sort(answers.begin(), answers.end());
    sorted.AddAll(answers);
    sorted.Add(answers.size());
    answers.clear();
  };
  Spread<Bound> spread(1.0f, 5);
  Random random(6);
  BroadPhase<View> bodies({.moves_are_seen_at_once = true});
  Ids ids;
  std::vector<Bound> bounds;
  for (std::uint32_t id = 0; id < kBodies; ++id) {
    ids.push_back(3 * id);
    bounds.push_back(spread.Next());
  }
  bodies.Insert(ids, bounds);
  for (std::size_t step = 0; step < 40; ++step) {
    Ids some;
    std::vector<Bound> moved;
    for (std::size_t i = 0; i < (step % 5 == 0 ? 4000 : 500); ++i) {
      const std::size_t body = random() % kBodies;
      if (!bodies.Has(ids[body])) continue;
      const float way = static_cast<float>(random() % 64) / 64;
      for (std::size_t k = 0; k < Bound::kAxes; ++k) {
        bounds[body].min[k] += way;
        bounds[body].max[k] += way;
      }
      if (random() % 16 == 0) bounds[body] = spread.Next();
      some.push_back(ids[body]);
      moved.push_back(bounds[body]);
    }
    bodies.Move(some, moved);
    if (step % 4 == 0) {
      bodies.Erase(some);
    } else if (step % 4 == 1) {
      for (std::size_t body = 0; body < kBodies; ++body) {
        if (!bodies.Has(ids[body])) bodies.Insert(ids[body], bounds[body]);
      }
    }
    if (step % 3 == 0) bodies.Update();
    if (step == 20) bodies.Rebuild();
    Spread<Bound> queries(4.0f * static_cast<float>(step % 3), step);
    ForEachSurvivor(bodies, queries.Next(), add, {.target = target});
    end_call();
    Sphere<kDims> sphere{};
    sphere.radius = static_cast<float>(step);
    ForEachSurvivor(bodies, sphere, add, {.target = target});
    end_call();
    Ray<kDims> ray{};
    ray.direction.fill(1);
    ray.direction[0] = static_cast<float>(step) - 12;
    ray.max_t = 40;
    RayCast(bodies, ray, add_hit, {.target = target});
    end_call();
    Aabb<kDims> box{};
    box.max.fill(1);
    BoxCast(bodies, box, ray.direction, 40, add_hit, {.target = target});
    end_call();
    SphereCast(bodies, Sphere<kDims>{{}, 2}, ray.direction, 40, add_hit,
               {.target = target});
    end_call();
    if (step % 4 != 0) {
      some.resize(200);
      PairOptions options;
      options.margin = 0.5f;
      options.target = target;
      ForEachPairOf(bodies, some, add_pairs, options);
      end_call();
    }
    bodies.UpdatePairs();
    add_pairs(bodies.began());
    add_pairs(bodies.ended());
    sorted.AddAll(answers);  // they come sorted
    answers.clear();
  }
  ASSERT_GT(bodies.pairs().size(), 100u);
  ASSERT_TRUE(bodies.Validate());
  const std::string name = "BroadPhase" + NameOf(View());
  EXPECT_TRUE(IsKnown(name, sorted.value()));
  EXPECT_TRUE(IsKnown(name + "Order", order.value()));
}

TEST(BroadPhaseHashTest, AnswersAreTheSameEverywhere) {
  for (Target target : TargetsUnderTest()) {
    SCOPED_TRACE(target.name());
    ExpectKnownAnswers<AabbView3>(target);
    ExpectKnownAnswers<AaboView3>(target);
#if !defined(HALFSPACE_TEST_ONLY_3D)
    ExpectKnownAnswers<AabbView2>(target);
    ExpectKnownAnswers<AaboView2>(target);
#endif
  }
}

// Hits in the order of the hierarchy, first hits and closest points. The
// corners are on a grid, so that many triangles share a center and many
// distances are equal.
TEST(MeshHashTest, AnswersAreTheSameEverywhere) {
  constexpr std::uint32_t kSide = 24;
  std::mt19937 random(1);
  const auto point = [&](std::uint32_t side) {
    Point3 made;
    for (float& x : made) x = static_cast<float>(random() % side);
    return made;
  };
  std::vector<Triangle3> triangles(6000);
  for (Triangle3& triangle : triangles) {
    triangle = {point(kSide), {}, {}};
    for (Point3* corner : {&triangle.b, &triangle.c}) {
      const Point3 way = point(4);
      for (std::size_t k = 0; k < 3; ++k) {
        (*corner)[k] = triangle.a[k] + way[k];
      }
    }
  }
  const TriangleMesh mesh(triangles);
  std::vector<Ray3> rays;
  for (std::size_t i = 0; i < 300; ++i) {
    Ray3 ray{point(kSide), point(9), 16};
    for (float& x : ray.direction) x -= 4;
    rays.push_back(ray);
  }
  for (Target target : TargetsUnderTest()) {
    SCOPED_TRACE(target.name());
    FnvHash hash;
    std::size_t hits = 0;
    for (const Ray3& ray : rays) {
      mesh.ForEachHit(
          ray,
          [&](std::uint32_t id, float t) {
            hash.Add(id);
            hash.AddFloat(t);
            ++hits;
          },
          target);
      MeshHit first;
      mesh.FirstHits({&ray, 1}, {&first, 1}, target);
      hash.Add(first.id);
      MeshPoint closest;
      mesh.ClosestPoints({&ray.origin, 1}, {&closest, 1},
                         std::numeric_limits<float>::infinity(), target);
      hash.Add(closest.id);
      hash.AddFloat(closest.distance);
      hash.AddAllFloats(closest.point);
    }
    ASSERT_GT(hits, 1000u);
    EXPECT_TRUE(IsKnown("TriangleMesh", hash.value()));
  }
}

}  // namespace
}  // namespace halfspace::testing
