// One constant per bulk builder and number of dimensions that stands for its
// bounds of many seeded shapes: the same on every target, compiler and machine,
// and for every layout of the source.
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
#include <utility>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/library/fit_many/laid_out.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

// In 2, 3 and 4 dimensions.
const std::map<std::string, std::array<std::uint64_t, 3>> kExpected = {
    {"boxes", {0x47a242ef405cce89, 0xb78431f00dbf4cde, 0x1d5b9241955eed8b}},
    {"boxes, inverted are empty",
     {0xd8c6c17c3160d949, 0x80343c31567587da, 0xdb8b65ab5394d9f0}},
    {"boxes, inverted are empty, tightest",
     {0xd8c6c17c3160d949, 0x298aaa87860f635e, 0xdb8b65ab5394d9f0}},
    {"boxes, tightest",
     {0x47a242ef405cce89, 0x3882bcf02d6ef02a, 0x1d5b9241955eed8b}},
    {"point sets",
     {0x5b364a721765e1f7, 0x2f8e85d85a686620, 0x6dd09a68957cffda}},
    {"point sets, tightest",
     {0x5b364a721765e1f7, 0x15cb7661bb54d4d2, 0x6dd09a68957cffda}},
    {"spheres", {0xaa6508d15daa2530, 0x9104841d4ece0d5f, 0x55b0e20bd9187fdf}},
    {"spheres, tightest",
     {0xb19667a27881baf1, 0x8e0911ef07f11282, 0x4fffa424485f22cf}},
    {"triangles", {0x806137546ffa69fa, 0x302a2e332d13389c, 0x094fece9b88879b8}},
    {"triangles, tightest",
     {0x806137546ffa69fa, 0xbd8b7cfab76a76a0, 0x094fece9b88879b8}},
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
struct Builder {
  const char* name;
  Inverted inverted;
  void (*build)(const AaboPlanes<kDims>& planes, const Run& run);
};

template <int kDims>
constexpr std::array kBuilders = {
    Builder<kDims>{"boxes", Inverted::kEverything, &BuildBoxes<kDims>},
    Builder<kDims>{"boxes, inverted are empty", Inverted::kEmpty,
                   &BuildBoxes<kDims>},
    Builder<kDims>{"point sets", Inverted::kEverything, &BuildPointSets<kDims>},
    Builder<kDims>{"spheres", Inverted::kEverything, &BuildSpheres<kDims>},
    Builder<kDims>{"triangles", Inverted::kEverything, &BuildTriangles<kDims>},
};

template <int kDims>
std::uint64_t HashOf(const Builder<kDims>& builder, Layout layout,
                     const FitOptions& options) {
  Output<kDims> output;
  FitStatus status;
  builder.build(output.planes(), {layout, options, &status});
  FnvHash hash;
  output.AddTo(hash);
  hash.Add(status.results);
  hash.Add(status.everything);
  hash.Add(status.first_everything);
  EXPECT_LT(status.everything, status.results / 4);
  return hash.value();
}

template <typename Dims>
class BulkHashTest : public ::testing::Test {};

TYPED_TEST_SUITE(BulkHashTest, AllDims, DimsNames);

TYPED_TEST(BulkHashTest, IsTheSameEverywhere) {
  constexpr int kDims = TypeParam::value;
  for (const Builder<kDims>& builder : kBuilders<kDims>) {
    for (bool tightest : {false, true}) {
      const std::string name =
          std::string(builder.name) + (tightest ? ", tightest" : "");
      const std::uint64_t expected = kExpected.at(name)[kDims - 2];
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
  }
}

}  // namespace
}  // namespace halfspace::testing
