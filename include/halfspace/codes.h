// Coded worlds: bounds as codes of one or two bytes a plane, to be tested at a
// quarter or half of the bytes, and so up to four times as fast.
//
// A test made of compares alone survives any monotone map of both its sides: a
// pair that floats do not reject is not rejected by codes either. A code is the
// rank of a value among quantiles of its plane, so that each plane rejects as
// much as its bits can, wherever the objects are; outliers cost nothing.
//
//   Codes         the codes of floats that the caller keeps
//   Confirmed     such codes and those floats: the exact answer
//   CodedWorld    a world that owns both, and keeps them in step
//
// All of them are worlds to the calls of reject.h and reject_many.h, with the
// queries of the floats.
//   Codes alone answer conservatively: they reject no pair that the floats
//   keep, and keep some that the floats reject; a few times as many survivors
//   with uint8 codes, a few in a thousand with uint16. Confirmed and CodedWorld
//   test what the codes leave on the floats too: the answer is that of the
//   floats, bit for bit.
//
// Memory: planes x sizeof(Code) bytes an object (an AABO in 3D: 8 or 16), and
// at most 1 KiB (uint8) or 256 KiB (uint16) a plane for the map.
//
// Special values: a NaN plane never rejects, infinities and Everything() are
// values like others. One object, equal objects, constant planes: conservative
// like all. Subnormals are coded as 0, so that a caller's DAZ mode changes
// nothing.
//
// Thread safety: as for any container. Source: monotone codes are this
// library's; docs/performance.md has the figures.
#ifndef HALFSPACE_CODES_H_
#define HALFSPACE_CODES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "halfspace/detail/code_book.h"
#include "halfspace/detail/coded_scan.h"
#include "halfspace/world.h"

namespace halfspace {

// The codes of the bounds of a world of floats. FloatView is SimplexView<D>,
// AabbView<D> or AaboView<D>; Code is std::uint8_t or std::uint16_t.
//
// The map is learnt from the bounds there are (Recode), and then kept: bounds
// that are set or pushed are coded by it, whatever their values. When they have
// moved so far that it does not tell them apart well, Fits() says so, and it is
// time for Recode again. Answers are right all the while.
//
// Errors: an index that is not below size() throws std::invalid_argument;
// memory that cannot be had throws std::bad_alloc.
template <typename FloatView, typename CodeType = std::uint8_t>
class Codes {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Code = CodeType;
  using View = detail::CodedView<FloatView, CodeType>;

  // None, and a map that has one code for everything: what is pushed survives
  // every query that is not empty, until Recode.
  Codes() = default;

  // Codes the bounds of `floats`.
  explicit Codes(const FloatView& floats) { Recode(floats); }

  std::size_t size() const { return planes_.size(); }
  bool empty() const { return size() == 0; }

  // Learns a new map from `floats` and codes all of them. About 20 ns an
  // object, and a sort of at most 2^16 values a plane (uint8; 2^18 with
  // uint16). Throws std::invalid_argument for a null or misaligned plane of a
  // view that is not empty; the codes are as they were then.
  void Recode(const FloatView& floats) {
    std::array<const float*, detail::kPlaneCount<Bound>> planes;
    std::size_t p = 0;
    for (const float* plane : floats.min) planes[p++] = plane;
    if constexpr (detail::HasMax<FloatView>) {
      for (const float* plane : floats.max) planes[p++] = plane;
    }
    planes_.Recode(planes, floats.size);
  }

  // Whether the map still tells the bounds apart about as well as when it was
  // learnt, judged by 1024 of them. False after pushes to an empty map. O(1).
  bool Fits() const { return planes_.Fits(); }

  // As in World, for the codes: keep them in step with the floats.
  std::size_t Push(const Bound& bound) {
    return planes_.Push(detail::Planes(bound));
  }
  void Set(std::size_t index, const Bound& bound) {
    planes_.Set(index, detail::Planes(bound));
  }
  void EraseBySwap(std::size_t index) { planes_.EraseBySwap(index); }
  void Reserve(std::size_t objects) { planes_.Reserve(objects); }

  // Removes all objects; keeps memory and map.
  void Clear() { planes_.Clear(); }

  // For the calls. Valid until the codes change.
  View view() const { return View(planes_); }

 private:
  detail::CodedPlanes<detail::StoredCode<CodeType>> planes_{
      Bound::kAxes, detail::kPlaneCount<Bound> - Bound::kAxes};
};

// Codes and the floats they were made from, in the same order: a world whose
// answers are those of the floats. The calls throw std::invalid_argument if the
// sizes differ; floats other than those that were coded are an error that
// cannot be seen, and falsely reject. Both must outlive it.
template <typename FloatView, typename CodeType>
detail::ConfirmedView<FloatView, CodeType> Confirmed(
    const Codes<FloatView, CodeType>& codes, const FloatView& floats) {
  return {codes.view(), floats};
}

// A world of floats with its codes. What it offers is what World offers, and
// costs that and about 20 ns for the codes; when it outgrows its memory, which
// costs O(size) anyway, and when it is assigned to, it learns a new map.
template <typename FloatView, typename CodeType = std::uint8_t>
class CodedWorld {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Code = CodeType;
  using View = detail::ConfirmedView<FloatView, CodeType>;

  CodedWorld() = default;

  // Takes the bounds of a world over, or copies them.
  explicit CodedWorld(World<FloatView> floats) : floats_(std::move(floats)) {
    Recode();
  }
  explicit CodedWorld(std::span<const Bound> bounds)
      : CodedWorld(World<FloatView>(bounds)) {}

  std::size_t size() const { return floats_.size(); }
  bool empty() const { return floats_.empty(); }

  std::size_t Push(const Bound& bound) {
    const bool grows = floats_.size() == floats_.capacity();
    const std::size_t index = floats_.Push(bound);
    codes_.Push(bound);
    if (grows) Recode();
    return index;
  }
  void Set(std::size_t index, const Bound& bound) {
    floats_.Set(index, bound);
    codes_.Set(index, bound);
  }
  Bound Get(std::size_t index) const { return floats_.Get(index); }
  void EraseBySwap(std::size_t index) {
    floats_.EraseBySwap(index);
    codes_.EraseBySwap(index);
  }
  void Clear() {
    floats_.Clear();
    codes_.Clear();
  }

  // As in Codes.
  bool Fits() const { return codes_.Fits(); }
  void Recode() { codes_.Recode(floats_.view()); }

  // The parts, for calls on codes or floats alone.
  const Codes<FloatView, CodeType>& codes() const { return codes_; }
  const World<FloatView>& floats() const { return floats_; }

  View view() const { return {codes_.view(), floats_.view()}; }

 private:
  World<FloatView> floats_;
  Codes<FloatView, CodeType> codes_;
};

}  // namespace halfspace

#endif  // HALFSPACE_CODES_H_
