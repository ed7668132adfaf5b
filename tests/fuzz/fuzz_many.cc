// The bulk builders against the builders of one shape, on every target, from
// and into memory of any alignment. fuzz_fit compares those with exact
// arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/fit_many/bulk_answers.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

const std::vector<Bulk>& Rows() {
  static const std::vector<Bulk> rows = Bulks();
  return rows;
}

class Many {
 public:
  explicit Many(Bytes& bytes)
      : mode_(kFpModes[bytes.Below(5)]),
        bulk_(Rows()[bytes.Below(Rows().size())]),
        layout_(kBulkLayouts[bytes.Below(kBulkLayouts.size())]),
        offset_(bytes.Below(16)),
        wanted_(bytes.Below(4) == 0 ? bytes.Byte() : 0xFF) {
    options_.tightest = bytes.Below(2) != 0;
    if (bytes.Below(2) != 0) options_.inverted = Inverted::kEmpty;
    for (std::size_t i = 0; i < distinct_.size(); ++i) {
      std::size_t numbers = bulk_.single().roles.size();
      if (bulk_.kind == Kind::kPoints) numbers = bytes.Below(40) * bulk_.dims;
      for (std::size_t n = 0; n < numbers; ++n) {
        distinct_[i].push_back(bulk_.is_double ? bytes.Double()
                                               : bytes.Float());
      }
      if (bulk_.kind != Kind::kBox || bytes.Below(4) == 0) continue;
      for (std::size_t k = 0; k < bulk_.dims; ++k) {
        auto& min = distinct_[i][k];
        auto& max = distinct_[i][bulk_.dims + k];
        if (min > max) std::swap(min, max);
      }
    }
    choices_.resize(bytes.Below(150));
    const std::uint32_t pattern = bytes.Word();
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      choices_[i] = std::rotl(pattern, static_cast<int>(7 * i)) % 4;
    }
    bad_index_ = bytes.Below(1 << 16);
  }

  ::testing::AssertionResult Check() const {
    BulkShapes shapes;
    for (std::size_t choice : choices_) shapes.push_back(distinct_[choice]);
    if (std::any_of(shapes.begin(), shapes.end(), [this](const auto& shape) {
          return IsAtTheLimit(shape);
        })) {
      return ::testing::AssertionSuccess();
    }
    BulkAnswers answers(bulk_, shapes, options_);
    Arena arena(offset_, Arena::kFiniteCanary);
    BulkSource source(bulk_, shapes);
    // A corner of a triangle that does not exist.
    const std::size_t corner = bad_index_ / 2;
    const bool has_bad = bad_index_ % 2 != 0 &&
                         corner < source.indices.size() &&
                         bulk_.kind == Kind::kTriangle;
    if (has_bad) {
      source.indices[corner] =
          static_cast<std::uint32_t>(source.indices.size() + bad_index_);
      answers.Set(corner / 3, bulk_.single().Everything());
    }
    source.Place(arena, layout_);
    return answers.Check(source, arena, wanted_, mode_);
  }

  friend std::ostream& operator<<(std::ostream& out, const Many& many) {
    out << many.bulk_ << ", layout " << static_cast<int>(many.layout_)
        << ", offset " << many.offset_ << ", planes " << many.wanted_
        << ", tightest " << many.options_.tightest << ", inverted "
        << static_cast<int>(many.options_.inverted) << ", bad index "
        << many.bad_index_ << ", in the mode " << static_cast<int>(many.mode_)
        << "\nshapes " << Print(many.choices_) << " of";
    for (const auto& shape : many.distinct_) out << ' ' << Print(shape);
    return out;
  }

 private:
  // Whether rounding decides if the shape can be bounded, and so the order of
  // the sum.
  bool IsAtTheLimit(const std::vector<double>& numbers) const {
    const std::size_t in_point =
        bulk_.dims + (bulk_.kind == Kind::kSphere ? 1 : 0);
    for (std::size_t i = 0; i < numbers.size(); i += in_point) {
      double sum = 0;
      for (std::size_t k = 0; k < in_point; ++k)
        sum += std::fabs(numbers[i + k]);
      if (std::fabs(sum - 0x1p125) <= 0x1p105) return true;
    }
    return false;
  }

  FpMode mode_;
  const Bulk& bulk_;
  FitOptions options_;
  BulkLayout layout_;
  std::size_t offset_;
  std::uint32_t wanted_;  // a bit for each plane
  std::array<std::vector<double>, 4> distinct_;
  std::vector<std::size_t> choices_;
  std::size_t bad_index_;
};

}  // namespace

void RunInput(Bytes& bytes) { Run<Many>(bytes); }

}  // namespace halfspace::testing
