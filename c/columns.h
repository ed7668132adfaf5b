// Records of the caller's, checked, and as rows of floats.
#ifndef HALFSPACE_C_COLUMNS_H_
#define HALFSPACE_C_COLUMNS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "c/call.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"
#include "halfspace/world.h"

namespace halfspace::c {

inline constexpr std::size_t kMostValues = 8;  // of a record of bounds

using detail::PlaneLayout;

// Fails unless it is one of the enumerators.
PlaneLayout LayoutOf(const Call& call, const char* argument, hs_kind kind);

// Returns 0, which is no enumerator, if there is none with these planes.
hs_kind KindOf(const PlaneLayout& layout);

// The values of a record, which has maxima for simplices too.
inline std::size_t RecordValues(const PlaneLayout& layout) {
  return std::size_t{2} * layout.axes;
}

// Calls function(view) for the type of world with these planes.
template <typename Function>
decltype(auto) WithView(const PlaneLayout& layout, const Function& function) {
  const bool is_flat = layout.dims == 2;
  switch (layout.kind) {
    case PlaneLayout::kSimplex:
      return is_flat ? function(SimplexView2()) : function(SimplexView3());
    case PlaneLayout::kAabb:
      return is_flat ? function(AabbView2()) : function(AabbView3());
    default:
      return is_flat ? function(AaboView2()) : function(AaboView3());
  }
}

// Which values of a record are read. They become the values of a row: first
// the minima, which are rounded down, then the others, which are rounded up.
struct Values {
  std::array<std::uint8_t, kMostValues> column;
  std::size_t count;
  std::size_t minima;

  static Values OfObjects(const PlaneLayout& layout);
  static Values OfQueries(const PlaneLayout& layout);
  // The first columns, in their order.
  static Values OfColumns(std::size_t count);
  static Values OfBoxes(std::size_t dims);
  // Points as boxes, whose corners are the same point.
  static Values OfPoints(std::size_t dims);
};

// Fails unless columns first ... first + count - 1 can be read.
void CheckColumns(const Call& call, const char* argument,
                  const hs_columns* columns, std::size_t first,
                  std::size_t count);
void CheckColumns(const Call& call, const char* argument,
                  const hs_columns* columns, const Values& values);

// Fails if columns that passed CheckColumns() are doubles, of values that
// cannot be rounded outward.
void CheckFloats(const Call& call, const char* argument,
                 const hs_columns& columns);

// Fails unless `value`, of a column of record `i`, is not negative. `values`
// and `record` are the names of such values and of a record.
void CheckNotNegative(const Call& call, const char* argument,
                      std::size_t column, const char* values,
                      const char* record, std::size_t i, float value);

// The rows in the caller's memory, or null if they are stored in another way.
const float* RowsInPlace(const hs_columns& columns, const Values& values);

// Writes the rows of `count` records from record `begin` on.
void WriteRows(const hs_columns& columns, const Values& values,
               std::size_t begin, std::size_t count, float* rows);

// Calls run(rows, begin, count) for up to 256 records at a time.
inline constexpr std::size_t kMostRows = 256;
template <typename Function>
void ForEachRows(const hs_columns& columns, const Values& values,
                 const Function& run) {
  const float* const in_place = RowsInPlace(columns, values);
  std::array<float, kMostRows * kMostValues> buffer;
  for (std::size_t begin = 0; begin < columns.count; begin += kMostRows) {
    const std::size_t count = std::min(columns.count - begin, kMostRows);
    const float* rows = buffer.data();
    if (in_place != nullptr) {
      rows = in_place + begin * values.count;
    } else {
      WriteRows(columns, values, begin, count, buffer.data());
    }
    run(rows, begin, count);
  }
}

using FloatVector = std::vector<float, detail::BlockAllocator<float>>;

// All rows, in place or as a copy.
class AllRows {
 public:
  AllRows(const hs_columns& columns, const Values& values,
          const MemoryResource& memory);

  Span<const float> floats() const { return floats_; }

 private:
  FloatVector copy_;
  Span<const float> floats_;
};

// The columns themselves.
detail::Columns ColumnsOf(const hs_columns& columns, const Values& values);

// The results behind those that are skipped, which go to an array with room for
// some of them.
template <typename Result>
class ResultRoom {
 public:
  ResultRoom(Result* results, std::size_t room, std::size_t skip)
      : results_(results), room_(room), skip_(skip) {}

  std::size_t total() const { return total_; }

  // How many of the next results are skipped, and where the others go.
  std::size_t skip() const { return skip_ > total_ ? skip_ - total_ : 0; }
  std::size_t written() const {
    return std::min(total_ > skip_ ? total_ - skip_ : 0, room_);
  }
  Span<Result> span() const {
    if (written() == room_) return {};
    return {results_ + written(), room_ - written()};
  }
  void Add(std::size_t count) { total_ += count; }

 private:
  Result* results_;
  std::size_t room_;
  std::size_t skip_;
  std::size_t total_ = 0;
};

}  // namespace halfspace::c

#endif  // HALFSPACE_C_COLUMNS_H_
