// The builders of many bounds as the rows of a table, and sources for them.
// What the bound of each shape has to be, the row of the builder of one such
// shape says (fit/builders.h).
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/library/fit/builders.h"
#include "tests/library/support/dims.h"

#if defined(__unix__)
#include "tests/library/support/guarded_memory.h"
#endif

namespace halfspace::testing {

// Memory for inputs and outputs that is as awkward as a test asks for.
// Every array starts `offset` elements past a 64-byte boundary, between
// canaries; or, where it is asked for, right at a page that cannot be touched.
class Arena {
 public:
  // By default canaries are NaN, so that an input that is read by mistake shows
  // among others; where it has to be refused, it must not be one.
  static constexpr std::uint32_t kNanCanary = 0x7fc0c5c5u;
  static constexpr std::uint32_t kFiniteCanary = 0x3f8000c5u;

  explicit Arena(std::size_t offset = 0, std::uint32_t canary = kNanCanary)
      : offset_(offset), canary_(canary) {}

#if defined(__unix__)
  explicit Arena(GuardedSide side) : side_(side) {}
#endif

  template <typename T>
  T* New(std::size_t count) {
    static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
#if defined(__unix__)
    if (side_) {
      guarded_.push_back(std::make_unique<GuardedMemory>(count * sizeof(T)));
      return guarded_.back()->Get<T>(count, *side_).data();
    }
#endif
    Block& block = blocks_.emplace_back();
    block.words.assign(kAround * 3 + (offset_ + count) * sizeof(T) / 4,
                       canary_);
    const auto address = reinterpret_cast<std::uintptr_t>(block.words.data());
    block.begin = kAround + (64 - address % 64) / 4 + offset_ * sizeof(T) / 4;
    block.end = block.begin + count * sizeof(T) / 4;
    return reinterpret_cast<T*>(block.words.data() + block.begin);
  }

  // Nothing was written around any array.
  bool Intact() const {
    const auto is_canary = [this](std::uint32_t word) {
      return word == canary_;
    };
    for (const Block& block : blocks_) {
      const auto begin = block.words.begin();
      if (!std::all_of(begin, begin + static_cast<std::ptrdiff_t>(block.begin),
                       is_canary) ||
          !std::all_of(begin + static_cast<std::ptrdiff_t>(block.end),
                       block.words.end(), is_canary)) {
        return false;
      }
    }
    return true;
  }

 private:
  static constexpr std::size_t kAround = 64;  // words; longer than any vector

  struct Block {
    std::vector<std::uint32_t> words;
    std::size_t begin;
    std::size_t end;
  };

  std::size_t offset_ = 0;
  std::uint32_t canary_ = kNanCanary;
  std::list<Block> blocks_;
#if defined(__unix__)
  std::optional<GuardedSide> side_;
  std::vector<std::unique_ptr<GuardedMemory>> guarded_;
#endif
};

// Where the numbers of shapes or points lie. Columns of points have no stride:
// for kStrided they are structures too.
enum class BulkLayout {
  kColumns,  // each column on its own, one value after the other
  kStrided,  // each column on its own, with gaps
  kPacked,   // an array of structures with nothing else in it
  kSpread,   // an array of structures with gaps
};
inline constexpr std::array kBulkLayouts = {
    BulkLayout::kColumns, BulkLayout::kStrided, BulkLayout::kPacked,
    BulkLayout::kSpread};

struct Bulk {
  std::string name;
  Kind kind;  // kPoints: point sets
  std::size_t dims;
  bool is_double;

  bool IsOfPoints() const {
    return kind == Kind::kTriangle || kind == Kind::kPoints;
  }
  std::size_t columns() const {
    return kind == Kind::kBox      ? 2 * dims
           : kind == Kind::kSphere ? dims + 1
                                   : dims;
  }
  std::size_t planes() const { return 2 * (dims + 1); }
  const Builder& single() const { return BuilderOf(kind, dims, is_double); }

  // What a row of this kind makes of one shape: mistakes become Everything().
  Planes Single(const std::vector<double>& numbers) const {
    if (kind != Kind::kPoints) return SingleBy(single(), numbers);
    // The bound of a set has the extremes of the bounds of its points.
    const Builder& segment = BuilderOf(Kind::kSegment, dims, is_double);
    const Planes everything = segment.Everything();
    Planes bound = segment.Empty();
    for (auto at = numbers.begin(); at != numbers.end();
         at += static_cast<std::ptrdiff_t>(dims)) {
      std::vector<double> twice(at, at + static_cast<std::ptrdiff_t>(dims));
      twice.insert(twice.end(), at, at + static_cast<std::ptrdiff_t>(dims));
      const Planes point = SingleBy(segment, twice);
      if (point == everything) return everything;
      for (std::size_t p = 0; p < planes(); ++p) {
        bound[p] = p <= dims ? std::min(bound[p], point[p])
                             : std::max(bound[p], point[p]);
      }
    }
    return bound;
  }

  friend std::ostream& operator<<(std::ostream& out, const Bulk& bulk) {
    return out << bulk.name;
  }

 private:
  static Planes SingleBy(const Builder& builder,
                         const std::vector<double>& numbers) {
    Shape shape;
    for (std::size_t i = 0; i < numbers.size(); ++i) shape.Set(i, numbers[i]);
    try {
      return builder.Build(shape);
    } catch (const std::invalid_argument&) {
      return builder.Everything();
    }
  }
};

inline std::vector<Bulk> Bulks() {
  std::vector<Bulk> bulks;
  for (std::size_t dims : TestDims()) {
    for (bool is_double : {false, true}) {
      const std::string suffix =
          std::to_string(dims) + (is_double ? "Double" : "");
      bulks.push_back({"BoundBoxes" + suffix, Kind::kBox, dims, is_double});
      bulks.push_back(
          {"BoundSpheres" + suffix, Kind::kSphere, dims, is_double});
      bulks.push_back(
          {"BoundTriangles" + suffix, Kind::kTriangle, dims, is_double});
      bulks.push_back(
          {"BoundPointSets" + suffix, Kind::kPoints, dims, is_double});
    }
  }
  return bulks;
}

using BulkShapes = std::vector<std::vector<double>>;

class BulkSource {
 public:
  BulkSource(const Bulk& bulk, const BulkShapes& shapes)
      : size(shapes.size()), bulk_(&bulk) {
    for (const auto& shape : shapes) {
      numbers_.insert(numbers_.end(), shape.begin(), shape.end());
      ends.push_back(numbers_.size() / bulk.columns());
    }
    // Corners of triangles are in reverse.
    for (std::size_t i = 0; bulk.IsOfPoints() && i < Count(); ++i) {
      indices.push_back(static_cast<std::uint32_t>(i));
    }
    if (bulk.kind != Kind::kTriangle) return;
    std::reverse(indices.begin(), indices.end());
    std::reverse(numbers_.begin(), numbers_.end());
    const auto columns = static_cast<std::ptrdiff_t>(bulk.columns());
    for (auto at = numbers_.begin(); at != numbers_.end(); at += columns) {
      std::reverse(at, at + columns);
    }
  }

  void Place(Arena& arena, BulkLayout layout) {
    if (bulk_->is_double) {
      PlaceAs<double>(arena, layout);
    } else {
      PlaceAs<float>(arena, layout);
    }
    placed_indices_ = Copied(arena, indices);
    placed_ends_ = Copied(arena, ends);
  }

  Target Bound(const detail::Output& output, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    Target target;
    const auto bound = [&]<int kDims>(DimsConstant<kDims>) {
      if (bulk_->dims != kDims) return;
      target = bulk_->is_double
                   ? BoundAs<kDims, double>(output, options, status)
                   : BoundAs<kDims, float>(output, options, status);
    };
#if !defined(HALFSPACE_TEST_ONLY_3D)  // which a library of 3D alone lacks
    bound(DimsConstant<2>());
    bound(DimsConstant<4>());
#endif
    bound(DimsConstant<3>());
    return target;
  }

  std::size_t size;                    // number of shapes
  std::vector<std::uint32_t> indices;  // of triangles
  std::vector<std::size_t> ends;       // of point sets

 private:
  // Boxes, spheres or points.
  std::size_t Count() const { return numbers_.size() / bulk_->columns(); }

  template <typename T>
  static Span<const T> Copied(Arena& arena, const std::vector<T>& from) {
    T* const memory = arena.New<T>(from.size());
    std::copy(from.begin(), from.end(), memory);
    return {memory, from.size()};
  }

  template <typename T>
  void PlaceAs(Arena& arena, BulkLayout layout) {
    is_soa_ = layout == BulkLayout::kColumns;
    if (bulk_->IsOfPoints() && layout == BulkLayout::kStrided) {
      layout = BulkLayout::kSpread;
    }
    const bool is_structure =
        layout == BulkLayout::kPacked || layout == BulkLayout::kSpread;
    const std::size_t columns = bulk_->columns();
    stride_ = layout == BulkLayout::kColumns  ? 1
              : layout == BulkLayout::kPacked ? columns
                                              : columns + 3;
    const std::size_t width = is_structure ? columns : 1;
    const std::size_t scalars =
        Count() == 0 ? 0 : (Count() - 1) * stride_ + width;
    T* memory = nullptr;
    for (std::size_t c = 0; c < columns; ++c) {
      if (!is_structure || c == 0) memory = arena.New<T>(scalars);
      T* const column = is_structure ? memory + c : memory;
      columns_[c] = column;
      for (std::size_t i = 0; i < Count(); ++i) {
        column[i * stride_] = static_cast<T>(numbers_[i * columns + c]);
      }
    }
  }

  template <int kDims, typename T>
  Target BoundAs(const detail::Output& output, const FitOptions& options,
                 FitStatus* status) const {
    const auto column = [this](std::size_t c) {
      return static_cast<const T*>(columns_[c]);
    };
    if (bulk_->kind == Kind::kBox) {
      Boxes<kDims, T> boxes{.count = size, .stride = stride_};
      for (std::size_t k = 0; k < kDims; ++k) {
        boxes.min[k] = column(k);
        boxes.max[k] = column(kDims + k);
      }
      return detail::BoundBoxes(detail::SourceOf<detail::kFitBoxes>(boxes),
                                output, options, status);
    }
    if (bulk_->kind == Kind::kSphere) {
      Spheres<kDims, T> spheres{
          .radius = column(kDims), .count = size, .stride = stride_};
      for (std::size_t k = 0; k < kDims; ++k) spheres.center[k] = column(k);
      return detail::BoundSpheres(
          detail::SourceOf<detail::kFitSpheres>(spheres), output, options,
          status);
    }
    const auto of_points = [&](const auto& points) {
      return bulk_->kind == Kind::kTriangle
                 ? detail::BoundTriangles(
                       detail::SourceOf<detail::kFitTriangles>(points),
                       placed_indices_, output, options, status)
                 : detail::BoundPointSets(
                       detail::SourceOf<detail::kFitPointSets>(points),
                       placed_ends_, output, options, status);
    };
    if (!is_soa_) {
      return of_points(Points<kDims, T>{column(0), Count(), stride_});
    }
    PointsSoa<kDims, T> soa{.coords = {}, .count = Count()};
    for (std::size_t k = 0; k < kDims; ++k) soa.coords[k] = column(k);
    return of_points(soa);
  }

  const Bulk* bulk_;
  std::vector<double> numbers_;
  std::array<const void*, 8> columns_{};
  std::size_t stride_ = 1;
  bool is_soa_ = false;
  Span<const std::uint32_t> placed_indices_;
  Span<const std::size_t> placed_ends_;
};

// Planes of bounds in memory of an arena.
class BulkOutput {
 public:
  BulkOutput(const Bulk& bulk, std::size_t size, Arena& arena)
      : planes_(bulk.planes()) {
    output_.size = size;
    for (std::size_t p = 0; p < planes_; ++p) {
      output_.Want(p, arena.New<float>(size));
    }
  }

  const detail::Output& output() const { return output_; }
  Planes Get(std::size_t i) const {
    Planes planes{};
    for (std::size_t p = 0; p < planes_; ++p) planes[p] = output_.planes[p][i];
    return planes;
  }

 private:
  std::size_t planes_;
  detail::Output output_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_H_
