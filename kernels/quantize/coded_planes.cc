#include <algorithm>
#include <cmath>
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

// Codes of equal rank are shared by one object in 256; a map that is four times
// worse rejects with two bits less.
double MostPairs(double times, double pairs_then) {
  return times * (pairs_then + 1.0 / 256);
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
  for (std::size_t p = 0; p < planes; ++p) pairs_then_[p] = CrowdOf(p).pairs;
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

// Of many codes, only the upper eight bits count. From up to 1024 objects.
template <typename Stored>
auto CodedPlanes<Stored>::CrowdOf(std::size_t plane) const -> Crowd {
  const std::size_t count = std::min<std::size_t>(size(), 1024);
  if (count == 0) return {};
  std::array<std::uint32_t, 256> histogram{};
  for (std::size_t i = 0; i < count; ++i) {
    const Stored code = codes_.plane(plane)[SampledIndex(i, count, size())];
    ++histogram[book_.BucketOf(book_.RankOf(plane, code))];
  }
  std::uint32_t pairs = 0;
  std::uint32_t fullest = 0;
  for (const std::uint32_t bucket : histogram) {
    pairs += bucket * bucket;
    fullest = std::max(fullest, bucket);
  }
  const auto all = static_cast<double>(count);
  return {.pairs = pairs / (all * all), .fullest = fullest / all};
}

template <typename Stored>
bool CodedPlanes<Stored>::Fits() const {
  for (std::size_t p = 0; p < book_.planes(); ++p) {
    if (CrowdOf(p).pairs > MostPairs(4.0, pairs_then_[p])) return false;
  }
  return true;
}

template <typename Stored>
std::size_t CodedPlanes<Stored>::Room() const {
  double room = 1.0;
  for (std::size_t p = 0; p < book_.planes(); ++p) {
    // Less than Fits() allows, as that will look at other objects.
    const double most = MostPairs(3.5, pairs_then_[p]);
    const Crowd crowd = CrowdOf(p);
    if (crowd.pairs >= most) return 0;
    if (most >= 1.0) continue;
    // The worst that can come: x times as many objects, all of them with the
    // most frequent code. Then pairs + 2 fullest x + x^2 = most (1 + x)^2.
    const double half = most - crowd.fullest;
    const double root =
        std::sqrt(half * half + (1.0 - most) * (most - crowd.pairs));
    room = std::min(room, (half + root) / (1.0 - most));
  }
  return static_cast<std::size_t>(room * static_cast<double>(size()));
}

template class CodedPlanes<std::int8_t>;
template class CodedPlanes<std::int16_t>;

}  // namespace halfspace::detail
