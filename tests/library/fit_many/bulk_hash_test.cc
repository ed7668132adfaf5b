// One constant per bulk builder that stands for its bounds of many seeded
// shapes: the same on every target, compiler and machine, and for every layout
// of the source.
//
// HALFSPACE_TEST_SCALE does not count here. If a bound is meant to change, the
// message of the failed test has the new constant.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/library/fit_many/laid_out.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

const std::map<std::string, std::uint64_t> kExpected = {
    {"boxes", 0x723b11bb6ea51574},
    {"boxes, inverted are empty", 0x4dbccd23e49ba5a3},
    {"boxes, inverted are empty, tightest", 0xc3614ca73adba52f},
    {"boxes, tightest", 0xdfbc340b482abbb0},
    {"point sets", 0x024592bc3b7bf9e1},
    {"point sets, tightest", 0xb746c859253e4e83},
    {"spheres", 0xa425bf83732d37f4},
    {"spheres, tightest", 0xf2bc89dccc683948},
    {"triangles", 0xbb5179f403768c6e},
    {"triangles, tightest", 0x2f6765ebff3bc1ca},
};

constexpr std::size_t kShapes = 5 * 64 + 37;
constexpr std::size_t kPoints = 1000;

template <std::size_t kColumns>
Rows<kColumns> SeededRows(std::size_t count, SeededNumbers& numbers) {
  Rows<kColumns> rows(count);
  for (auto& row : rows) row = numbers.Coordinates<kColumns>();
  return rows;
}

// The wanted planes, and their hash.
template <int kDims>
class Output {
 public:
  AaboPlanes<kDims> planes() {
    AaboPlanes<kDims> planes;
    planes.size = kShapes;
    for (std::size_t k = 0; k <= kDims; ++k) {
      planes.min[k] = floats_[k].data();
      planes.max[k] = floats_[kDims + 1 + k].data();
    }
    return planes;
  }

  void AddTo(FnvHash& hash) const {
    for (const auto& plane : floats_) hash.AddAllFloats(plane);
  }

 private:
  std::array<std::array<float, kShapes>, 2 * (kDims + 1)> floats_{};
};

// What a test runs: the same source again and again.
struct Run {
  Layout layout;
  FitOptions options;
  FitStatus* status;
};

template <int kDims>
void BuildBoxes(const AaboPlanes<kDims>& planes, const Run& run) {
  SeededNumbers numbers(kDims);
  auto rows = SeededRows<2 * kDims>(kShapes, numbers);
  for (auto& row : rows) {
    const std::uint32_t kind = numbers.Below(16);
    for (std::size_t k = 0; k < kDims; ++k) {
      // One in 16 stays as it is, and is most likely inverted.
      if (kind != 0 && row[k] > row[kDims + k]) {
        std::swap(row[k], row[kDims + k]);
      }
      if (kind == 1) {
        row[k] = std::numeric_limits<float>::infinity();
        row[kDims + k] = -row[k];
      }
    }
  }
  const LaidOut<2 * kDims> memory(rows, run.layout);
  Boxes<kDims> boxes{.count = kShapes, .stride = memory.stride()};
  for (std::size_t k = 0; k < kDims; ++k) {
    boxes.min[k] = memory.column(k);
    boxes.max[k] = memory.column(kDims + k);
  }
  BoundBoxes(boxes, planes, run.options, run.status);
}

template <int kDims>
void BuildSpheres(const AaboPlanes<kDims>& planes, const Run& run) {
  SeededNumbers numbers(kDims);
  auto rows = SeededRows<kDims + 1>(kShapes, numbers);
  for (auto& row : rows) {
    if (numbers.Below(16) != 0) row[kDims] = numbers.Length();
  }
  const LaidOut<kDims + 1> memory(rows, run.layout);
  Spheres<kDims> spheres{.radius = memory.column(kDims),
                         .count = kShapes,
                         .stride = memory.stride()};
  for (std::size_t k = 0; k < kDims; ++k) spheres.center[k] = memory.column(k);
  BoundSpheres(spheres, planes, run.options, run.status);
}

// Calls build(points), in either of their types.
template <int kDims, typename Build>
void WithPoints(SeededNumbers& numbers, Layout layout, Build build) {
  const LaidOut<kDims> memory(SeededRows<kDims>(kPoints, numbers), layout);
  if (layout == Layout::kColumns) {
    PointsSoa<kDims> points{.count = kPoints};
    for (std::size_t k = 0; k < kDims; ++k) points.coords[k] = memory.column(k);
    build(points);
  } else {
    build(Points<kDims>{memory.column(0), kPoints, memory.stride()});
  }
}

template <int kDims>
void BuildTriangles(const AaboPlanes<kDims>& planes, const Run& run) {
  SeededNumbers numbers(kDims);
  std::vector<std::uint32_t> indices(3 * kShapes);
  for (std::uint32_t& index : indices) {
    // Two in a thousand do not exist.
    index = numbers.Below(kPoints + 2);
  }
  WithPoints<kDims>(numbers, run.layout, [&](const auto& vertices) {
    BoundTriangles(vertices, indices, planes, run.options, run.status);
  });
}

template <int kDims>
void BuildPointSets(const AaboPlanes<kDims>& planes, const Run& run) {
  SeededNumbers numbers(kDims);
  std::vector<std::size_t> ends(kShapes);
  std::size_t end = 0;
  for (std::size_t& one : ends) {
    const std::uint32_t kind = numbers.Below(64);
    if (kind == 0) {
      end = 0;  // ends before it begins, if it is not the first
    } else if (kind == 1) {
      end += 150;
    } else {
      end += numbers.Below(9);
    }
    if (end > kPoints) end = numbers.Below(kPoints);
    one = end;
  }
  ends.back() = kPoints + 1;
  WithPoints<kDims>(numbers, run.layout, [&](const auto& points) {
    BoundPointSets(points, ends, planes, run.options, run.status);
  });
}

template <int kDims>
using BuildFunction = void (*)(const AaboPlanes<kDims>& planes, const Run& run);

struct Builder {
  const char* name;
  Inverted inverted;
  BuildFunction<2> build2;
  BuildFunction<3> build3;
  BuildFunction<4> build4;
};

constexpr std::array kBuilders = {
    Builder{"boxes", Inverted::kEverything, &BuildBoxes<2>, &BuildBoxes<3>,
            &BuildBoxes<4>},
    Builder{"boxes, inverted are empty", Inverted::kEmpty, &BuildBoxes<2>,
            &BuildBoxes<3>, &BuildBoxes<4>},
    Builder{"point sets", Inverted::kEverything, &BuildPointSets<2>,
            &BuildPointSets<3>, &BuildPointSets<4>},
    Builder{"spheres", Inverted::kEverything, &BuildSpheres<2>,
            &BuildSpheres<3>, &BuildSpheres<4>},
    Builder{"triangles", Inverted::kEverything, &BuildTriangles<2>,
            &BuildTriangles<3>, &BuildTriangles<4>},
};

template <int kDims>
void AddBounds(BuildFunction<kDims> build, Layout layout,
               const FitOptions& options, FnvHash& hash) {
  Output<kDims> output;
  FitStatus status;
  build(output.planes(), {layout, options, &status});
  output.AddTo(hash);
  hash.Add(status.results);
  hash.Add(status.everything);
  hash.Add(status.first_everything);
  EXPECT_LT(status.everything, status.results / 4);
}

std::uint64_t HashOf(const Builder& builder, Layout layout,
                     const FitOptions& options) {
  FnvHash hash;
  AddBounds<2>(builder.build2, layout, options, hash);
  AddBounds<3>(builder.build3, layout, options, hash);
  AddBounds<4>(builder.build4, layout, options, hash);
  return hash.value();
}

class BulkHashTest
    : public ::testing::TestWithParam<std::tuple<std::size_t, bool>> {};

TEST_P(BulkHashTest, IsTheSameEverywhere) {
  const auto [index, tightest] = GetParam();
  const Builder& builder = kBuilders[index];
  const std::string name =
      std::string(builder.name) + (tightest ? ", tightest" : "");
  const auto it = kExpected.find(name);
  const std::uint64_t expected = it == kExpected.end() ? 0 : it->second;
  for (Target target : TargetsUnderTest()) {
    for (Layout layout : kLayouts) {
      const std::uint64_t hash = HashOf(builder, layout,
                                        {.tightest = tightest,
                                         .inverted = builder.inverted,
                                         .target = target});
      EXPECT_EQ(hash, expected)
          << target.name() << ", layout " << static_cast<int>(layout)
          << ": the hash of " << name << " is 0x" << std::hex << hash;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Builders, BulkHashTest,
                         ::testing::Combine(::testing::Range(std::size_t{0},
                                                             kBuilders.size()),
                                            ::testing::Bool()));

}  // namespace
}  // namespace halfspace::testing
