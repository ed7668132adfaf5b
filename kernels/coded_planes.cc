#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "halfspace/detail/code_book.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// What lies past the objects is never looked at.
template <typename Stored>
PlaneArrays<Stored> NoPlanes(std::size_t planes) {
  const std::array<Stored, kMaxPlanes> padding{};
  return PlaneArrays<Stored>(std::span(padding).first(planes));
}

}  // namespace

template <typename Stored>
CodedPlanes<Stored>::CodedPlanes(std::size_t minima, std::size_t maxima)
    : book_(minima, maxima), codes_(NoPlanes<Stored>(minima + maxima)) {}

template <typename Stored>
void CodedPlanes<Stored>::Recode(const FloatColumns& floats) {
  const std::size_t planes = book_.planes();
  for (std::size_t p = 0; p < planes && floats.size != 0; ++p) {
    kernels::CheckPointer(
        "Codes::Recode", floats.planes[p], alignof(float),
        [&] { return "floats, plane " + std::to_string(p); },
        [&] {
          return "a plane of " + std::to_string(floats.size) + " floats";
        });
  }
  // Before a plane is read: a size that cannot exist is refused here.
  PlaneArrays<Stored> codes = NoPlanes<Stored>(planes);
  codes.Reserve(std::max(floats.size, codes_.capacity()));
  codes.Resize(floats.size);
  CodeBook book = book_;
  book.Learn(floats, std::size_t{1} << (8 * sizeof(Stored)));
  for (std::size_t p = 0; p < planes; ++p) {
    book.CodeObjects(p, floats.planes[p], floats.stride, floats.size,
                     codes.plane(p));
  }
  book_ = std::move(book);
  codes_ = std::move(codes);
  for (std::size_t p = 0; p < planes; ++p) crowding_then_[p] = Crowding(p);
}

template <typename Stored>
auto CodedPlanes<Stored>::CodesOf(std::span<const float> values) const
    -> Values {
  Values codes{};
  book_.CodeObject(values.data(), codes.data());
  return codes;
}

template <typename Stored>
std::size_t CodedPlanes<Stored>::Push(std::span<const float> values) {
  const Values codes = CodesOf(values);
  return codes_.Push(std::span(codes).first(values.size()));
}

template <typename Stored>
void CodedPlanes<Stored>::Set(std::size_t index,
                              std::span<const float> values) {
  CheckIndex(index, "Codes::Set");
  const Values codes = CodesOf(values);
  codes_.Set(index, std::span(codes).first(values.size()));
}

template <typename Stored>
void CodedPlanes<Stored>::EraseBySwap(std::size_t index) {
  CheckIndex(index, "Codes::EraseBySwap");
  codes_.EraseBySwap(index);
}

// How likely two objects are to have the same code, or, of many codes, the same
// upper eight bits of it: from up to 1024 of them.
template <typename Stored>
double CodedPlanes<Stored>::Crowding(std::size_t plane) const {
  const std::size_t count = std::min<std::size_t>(size(), 1024);
  if (count == 0) return 0.0;
  std::array<std::uint32_t, 256> histogram{};
  for (std::size_t i = 0; i < count; ++i) {
    const Stored code = codes_.plane(plane)[SampledIndex(i, count, size())];
    ++histogram[book_.BucketOf(book_.RankOf(plane, code))];
  }
  double pairs = 0.0;
  for (const std::uint32_t bucket : histogram) {
    pairs += static_cast<double>(bucket) * bucket;
  }
  return pairs / (static_cast<double>(count) * static_cast<double>(count));
}

template <typename Stored>
bool CodedPlanes<Stored>::Fits() const {
  // Codes of equal rank are shared by one object in 256; a map that is four
  // times worse rejects with two bits less.
  for (std::size_t p = 0; p < book_.planes(); ++p) {
    if (Crowding(p) > 4.0 * (crowding_then_[p] + 1.0 / 256)) return false;
  }
  return true;
}

template class CodedPlanes<std::int8_t>;
template class CodedPlanes<std::int16_t>;

}  // namespace halfspace::detail
