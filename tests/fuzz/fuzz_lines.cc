// Bounds of rays, and of segments in pieces, against exact arithmetic.
#include <array>
#include <cstddef>
#include <ostream>
#include <span>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/fit_input.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"

namespace halfspace::testing {
namespace {

template <int kTheDims>
class RayShape {
 public:
  static constexpr int kDims = kTheDims;

  explicit RayShape(Bytes& bytes) {
    ray_.max_t = bytes.Float();
    bytes.Fill(ray_.origin);
    bytes.Fill(ray_.direction);
  }

  void Describe(ExactShape<kDims>& exact) const {
    if (!(ray_.max_t >= 0)) return exact.Refuse();
    if (!exact.Accept(std::array{ray_.max_t}) || !exact.Accept(ray_.origin) ||
        !exact.Accept(ray_.direction)) {
      return;
    }
    const auto origin = ExactOf<std::size_t{kDims}>(ray_.origin);
    auto way = ExactOf<std::size_t{kDims}>(ray_.direction);
    auto end = origin;
    for (std::size_t k = 0; k < kDims; ++k) {
      way[k] *= mpq_class(ray_.max_t);
      end[k] += way[k];
    }
    exact.Weigh(SumOfMagnitudes(origin) + SumOfMagnitudes(way));
    exact.AddPoint(origin);
    exact.AddPoint(end);
  }
  Aabo<kDims> Build(FitStatus* status) const { return BoundRay(ray_, status); }
  friend std::ostream& operator<<(std::ostream& out, const RayShape& shape) {
    return out << "the ray from " << Print(shape.ray_.origin) << " along "
               << Print(shape.ray_.direction) << " up to "
               << Print(std::array{shape.ray_.max_t});
  }

 private:
  Ray<kDims> ray_;
};

template <int kDims>
class Pieces {
 public:
  explicit Pieces(Bytes& bytes) : mode_(bytes), count_(bytes.Below(40)) {
    bytes.Fill(segment_.a);
    bytes.Fill(segment_.b);
  }

  ::testing::AssertionResult Check() const {
    std::vector<Aabo<kDims>> pieces(count_);
    FitStatus status;
    mode_.Run([&] {
      BoundSegmentPieces(segment_, std::span<Aabo<kDims>>(pieces), &status);
    });
    std::size_t everything = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      everything += pieces[i] == Aabo<kDims>::Everything() ? 1 : 0;
      auto result = Describe(i).Check(pieces[i]);
      if (!result)
        return result << "\npiece " << i << ": min " << Print(pieces[i].min)
                      << ", max " << Print(pieces[i].max);
    }
    if (status.results == count_ && status.everything == everything &&
        status.first_everything == 0) {
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "a wrong status";
  }

  friend std::ostream& operator<<(std::ostream& out, const Pieces& pieces) {
    return out << "the segment from " << Print(pieces.segment_.a) << " to "
               << Print(pieces.segment_.b) << " in " << pieces.count_
               << " pieces, in the mode " << pieces.mode_;
  }

 private:
  ExactShape<kDims> Describe(std::size_t piece) const {
    ExactShape<kDims> exact;
    if (!exact.Accept(segment_.a) || !exact.Accept(segment_.b)) return exact;
    const auto a = ExactOf<std::size_t{kDims}>(segment_.a);
    const auto b = ExactOf<std::size_t{kDims}>(segment_.b);
    exact.Weigh(SumOfMagnitudes(a));
    exact.Weigh(SumOfMagnitudes(b));
    for (std::size_t i : {piece, piece + 1}) {
      auto point = a;
      const mpq_class along = mpq_class(i) / mpq_class(count_);
      for (std::size_t k = 0; k < kDims; ++k) {
        point[k] += along * (b[k] - a[k]);
      }
      exact.AddPoint(point);
    }
    exact.Tolerate({.ulps = 1}, {.ulps = 1});
    return exact;
  }

  CallerMode mode_;
  std::size_t count_;
  Segment<kDims> segment_;
};

template <int kDims>
using Inputs = ::testing::Types<FitInput<RayShape<kDims>>, Pieces<kDims>>;

}  // namespace

void RunInput(Bytes& bytes) { RunOneOfAllDims<Inputs>(bytes); }

}  // namespace halfspace::testing
