#include "c/columns.h"

#include <cstdint>

namespace halfspace::c {

namespace {

// Kind i + 1 is element i.
constexpr std::array<PlaneLayout, 6> kLayouts = {
    detail::kLayoutOf<Aabb<2>>,      detail::kLayoutOf<Aabb<3>>,
    detail::kLayoutOf<Aabo<2>>,      detail::kLayoutOf<Aabo<3>>,
    detail::kLayoutOf<UpSimplex<2>>, detail::kLayoutOf<UpSimplex<3>>};
static_assert(HS_BOX2 == 1 && HS_SIMPLEX3 == kLayouts.size());

const PlaneLayout* FindLayout(hs_kind kind) {
  const auto i = static_cast<std::size_t>(kind) - 1;
  return i < kLayouts.size() ? &kLayouts[i] : nullptr;
}

}  // namespace

PlaneLayout LayoutOf(const Call& call, const char* argument, hs_kind kind) {
  if (const PlaneLayout* const found = FindLayout(kind)) return *found;
  call.Fail(HS_INVALID_ARGUMENT, argument,
            "expected an enumerator of hs_kind, got %d",
            static_cast<int>(kind));
}

hs_kind KindOf(const PlaneLayout& layout) {
  for (std::size_t i = 0; i < kLayouts.size(); ++i) {
    if (kLayouts[i] == layout) return static_cast<hs_kind>(i + 1);
  }
  return static_cast<hs_kind>(0);
}

namespace {

Values Consecutive(std::size_t first, std::size_t count, std::size_t minima) {
  Values values{{}, count, minima};
  for (std::size_t v = 0; v < count; ++v) {
    values.column[v] = static_cast<std::uint8_t>(first + v);
  }
  return values;
}

}  // namespace

Values Values::OfObjects(const PlaneLayout& layout) {
  return Consecutive(0, layout.plane_count, layout.axes);
}

Values Values::OfQueries(const PlaneLayout& layout) {
  return Consecutive(layout.has_max ? 0 : layout.axes, layout.plane_count,
                     layout.first_max);
}

Values Values::OfColumns(std::size_t count) {
  return Consecutive(0, count, count);
}

Values Values::OfBoxes(std::size_t dims) {
  return Consecutive(0, 2 * dims, dims);
}

Values Values::OfPoints(std::size_t dims) {
  Values values{{}, 2 * dims, dims};
  for (std::size_t v = 0; v < values.count; ++v) {
    values.column[v] = static_cast<std::uint8_t>(v % dims);
  }
  return values;
}

void CheckColumns(const Call& call, const char* argument,
                  const hs_columns* columns, std::size_t first,
                  std::size_t count) {
  call.CheckPointer(argument, columns);
  if (columns->type != HS_FLOAT32 && columns->type != HS_FLOAT64) {
    call.Fail(HS_INVALID_ARGUMENT, {argument, "->type"},
              "expected an enumerator of hs_scalar, got %d",
              static_cast<int>(columns->type));
  }
  if (columns->count == 0) return;
  const std::size_t bytes =
      columns->type == HS_FLOAT64 ? sizeof(double) : sizeof(float);
  // A copy of the records must fit, too: with a stride of 0 they are many. One
  // record has no stride, and takes no division: it may be a whole call.
  if (columns->count > PTRDIFF_MAX / (kMostValues * sizeof(float)) ||
      (columns->count > 1 && columns->stride != 0 &&
       columns->count - 1 > (PTRDIFF_MAX / bytes - 1) / columns->stride)) {
    call.Fail(HS_INVALID_ARGUMENT, {argument, "->count"},
              "expected records that fit the address space, got %zu "
              "with a stride of %zu",
              columns->count, columns->stride);
  }
  for (std::size_t v = first; v < first + count; ++v) {
    const void* const column = columns->column[v];
    if (column == nullptr) {
      call.Fail(HS_INVALID_ARGUMENT, {argument, "->column", v},
                "expected a pointer, got null");
    }
    if ((reinterpret_cast<std::uintptr_t>(column) & (bytes - 1)) != 0) {
      call.Fail(HS_INVALID_ARGUMENT, {argument, "->column", v},
                "expected memory aligned to %zu bytes, got a "
                "misaligned pointer",
                bytes);
    }
  }
}

void CheckColumns(const Call& call, const char* argument,
                  const hs_columns* columns, const Values& values) {
  CheckColumns(call, argument, columns, values.column[0], values.count);
}

void CheckFloats(const Call& call, const char* argument,
                 const hs_columns& columns) {
  if (columns.type == HS_FLOAT32) return;
  call.Fail(HS_INVALID_ARGUMENT, {argument, "->type"},
            "expected HS_FLOAT32, as these cannot be rounded outward, got "
            "HS_FLOAT64");
}

void CheckNotNegative(const Call& call, const char* argument,
                      std::size_t column, const char* values,
                      const char* record, std::size_t i, float value) {
  if (value >= 0) return;
  call.Fail(HS_INVALID_ARGUMENT, {argument, "->column", column},
            "expected %s that are not negative, got %s of %s "
            "%zu",
            values, detail::NumberText(value).c_str(), record, i);
}

detail::Columns ColumnsOf(const hs_columns& columns, const Values& values) {
  detail::Columns result;
  result.size = columns.count;
  result.stride = columns.count > 1 ? columns.stride : 0;
  result.is_double = columns.type == HS_FLOAT64;
  for (std::size_t v = 0; v < values.count; ++v) {
    result.column[v] = columns.column[values.column[v]];
  }
  return result;
}

const float* RowsInPlace(const hs_columns& columns, const Values& values) {
  return columns.count == 0
             ? nullptr
             : detail::RowsOf(ColumnsOf(columns, values), values.count);
}

void WriteRows(const hs_columns& columns, const Values& values,
               std::size_t begin, std::size_t count, float* rows) {
  detail::ReadRecords(ColumnsOf(columns, values), values.count, values.minima,
                      begin, count, rows);
}

AllRows::AllRows(const hs_columns& columns, const Values& values,
                 const MemoryResource& memory)
    : copy_(detail::BlockAllocator<float>(memory)) {
  const float* rows = RowsInPlace(columns, values);
  if (rows == nullptr && columns.count != 0) {
    copy_.resize(columns.count * values.count);
    WriteRows(columns, values, 0, columns.count, copy_.data());
    rows = copy_.data();
  }
  floats_ = {rows, columns.count * values.count};
}

}  // namespace halfspace::c

size_t hs_bound_values(hs_kind kind) {
  const auto* const found = halfspace::c::FindLayout(kind);
  return found != nullptr ? halfspace::c::RecordValues(*found) : 0;
}
