// The shapes that the bulk builders are measured on, and the check of their
// answers, which must be able to fail.
#include "bench/worlds/build_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "bench/worlds/build_source.h"
#include "bench/worlds/scene.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kBytes = 200'000;

BuildSource SmallSource(BuildKind kind) {
  return MakeBuildSource(kind, MakeScene(500, 1, /*seed=*/3, [](double) {}),
                         kBytes);
}

TEST(BuildCheckTest, EveryBuildIsRight) {
  for (BuildKind kind : kBuildKinds) {
    const BuildSource source = SmallSource(kind);
    SCOPED_TRACE(source.shapes + " to " + source.planes);
    for (Target target : SupportedTargets()) {
      for (bool tightest : {false, true}) {
        EXPECT_EQ(CheckBuild(source, {.tightest = tightest, .target = target}),
                  "")
            << target.name();
      }
    }
    FitStatus status;
    source.build({}, &status);
    EXPECT_EQ(status.results, source.objects);
    EXPECT_EQ(status.everything, 0u);
  }
}

TEST(BuildCheckTest, SourcesAreAsLargeAsAsked) {
  for (BuildKind kind : kBuildKinds) {
    const BuildSource source = SmallSource(kind);
    SCOPED_TRACE(source.shapes + " to " + source.planes);
    EXPECT_LE(source.copy.bytes(), kBytes);
    EXPECT_GE(source.copy.bytes(), kBytes / 3);
    EXPECT_EQ(source.items,
              source.objects * (kind == BuildKind::kPointSets ? 50 : 1));
  }
}

// A source of boxes whose builder does `change` to object 0 afterwards.
template <typename Change>
std::string CheckAfter(const Change& change) {
  BuildSource source = SmallSource(BuildKind::kBoxes);
  source.build = [build = source.build, built = source.built, change](
                     const FitOptions& options, FitStatus* status) {
    const Target target = build(options, status);
    Aabo3 bound = built->Get(0);
    change(bound);
    built->Set(0, bound);
    return target;
  };
  return CheckBuild(source, {.target = ChosenTarget()});
}

TEST(BuildCheckTest, FindsAWrongBound) {
  EXPECT_EQ(CheckAfter([](Aabo3&) {}), "");
  EXPECT_EQ(CheckAfter([](Aabo3& bound) { bound.max[3] += 1.0f; }), "");
  EXPECT_NE(CheckAfter([](Aabo3& bound) { bound.min[3] += 1.0f; }), "");
  EXPECT_NE(CheckAfter([](Aabo3& bound) { bound.max[3] -= 1.0f; }), "");
  EXPECT_NE(CheckAfter([](Aabo3& bound) { bound.max[3] = NAN; }), "");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NE(CheckAfter([k](Aabo3& bound) { bound.min[k] -= 1.0f; }), "");
    EXPECT_NE(CheckAfter([k](Aabo3& bound) { bound.max[k] += 1.0f; }), "");
  }
}

TEST(BuildCheckTest, FindsABuilderThatDoesNothing) {
  for (BuildKind kind : kBuildKinds) {
    BuildSource source = SmallSource(kind);
    source.build({}, nullptr);
    source.build = [](const FitOptions& options, FitStatus*) {
      return options.target;
    };
    EXPECT_NE(CheckBuild(source, {.target = ChosenTarget()}), "");
  }
}

TEST(BuildCheckTest, FindsAnotherTarget) {
  BuildSource source = SmallSource(BuildKind::kSpheres);
  source.build = [build = source.build](const FitOptions& options,
                                        FitStatus* status) {
    build(options, status);
    return Target();
  };
  EXPECT_NE(CheckBuild(source, {.target = ChosenTarget()}), "");
}

}  // namespace
}  // namespace halfspace::bench
