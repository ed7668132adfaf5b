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
// at most 1.4 KiB (uint8) or 257 KiB (uint16) a plane for the map.
//
// Special values: a NaN plane never rejects, infinities and Everything() are
// values like others. One object, equal objects, constant planes: conservative
// like all. Subnormals are coded as 0, so that a caller's DAZ mode changes
// nothing. Floats are coded as integers, and trap no floating-point exception;
// to learn a map, and Fits(), may give inexact numbers, and what confirms codes
// is as in reject.h.
//
// Thread safety: as for any container. Source: monotone codes are this
// library's; docs/performance.md has the figures.
#ifndef HALFSPACE_CODES_H_
#define HALFSPACE_CODES_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/detail/block_memory.h"
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
// memory that cannot be had throws std::bad_alloc and a size that cannot exist
// std::invalid_argument, and the codes are as they were.
template <typename FloatView, typename CodeType = std::uint8_t>
class Codes {
  static_assert(std::is_same_v<typename FloatView::Bound::Scalar, float>,
                "codes are made from worlds of floats, not of doubles");

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
  explicit Codes(const World<FloatView>& floats) { Recode(floats); }

  std::size_t size() const { return planes_.size(); }
  bool empty() const { return size() == 0; }

  // Learns a new map from `floats` and codes all of them: about 0.1 us an
  // octahedron (0.3 with uint16), and a sort of at most 2^16 values a plane
  // (2^18 with uint16). Throws std::invalid_argument for a null or misaligned
  // plane of a view that is not empty; the codes are as they were then.
  void Recode(const FloatView& floats) {
    planes_.Recode(detail::ColumnsOf(floats));
  }
  void Recode(const World<FloatView>& floats) { Recode(floats.view()); }

  // The same for bounds in a list.
  void Recode(std::span<const Bound> bounds) {
    planes_.Recode(detail::ColumnsOf(bounds));
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

  // Throws, in the name of `call`, unless `index` is below size().
  void CheckIndex(std::size_t index, const char* call) const {
    planes_.CheckIndex(index, call);
  }

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
detail::ConfirmedView<FloatView, CodeType, FloatView> Confirmed(
    const Codes<FloatView, CodeType>& codes, const FloatView& floats) {
  return {codes.view(), floats};
}
template <typename FloatView, typename CodeType>
detail::ConfirmedView<FloatView, CodeType, FloatView> Confirmed(
    const Codes<FloatView, CodeType>& codes, const World<FloatView>& floats) {
  return {codes.view(), floats.view()};
}

// A world that owns its codes and its floats: those are as many bytes again as
// in a World. Errors are those of Codes, and the world is as it was.
//
// The world learns a map when it is made of bounds. Pushed to, it learns a new
// one when it has twice the objects that it learnt from, and before those that
// came, in the order of a plane, say, crowd a few codes; pushed to from
// nothing, and after Clear(), for the first time at 64. So Fits() holds while
// objects are pushed, from then on. What Set and EraseBySwap change, a Push
// later may learn; ask Fits() whether to call Recode().
//
// To set an object takes about 0.1 us; to push one, all told, 0.3 to 1 us
// (three times that in the order of a plane), for most of it is learning.
//
// Its floats are records, one after another, and not planes: few of them are
// looked at, and each is then one cache line instead of one for each plane.
template <typename FloatView, typename CodeType = std::uint8_t>
class CodedWorld {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Code = CodeType;
  using View =
      detail::ConfirmedView<FloatView, CodeType, std::span<const Bound>>;

  CodedWorld() = default;
  CodedWorld(const CodedWorld& other) = default;
  CodedWorld(CodedWorld&& other) noexcept  // leaves it empty
      : codes_(std::move(other.codes_)),
        records_(std::move(other.records_)),
        learnt_(std::exchange(other.learnt_, 0)),
        unlooked_(std::exchange(other.unlooked_, 0)) {}
  CodedWorld& operator=(const CodedWorld& other) {
    return *this = CodedWorld(other);
  }
  CodedWorld& operator=(CodedWorld&& other) noexcept {
    CodedWorld taken(std::move(other));
    std::swap(codes_, taken.codes_);
    records_.swap(taken.records_);
    std::swap(learnt_, taken.learnt_);
    std::swap(unlooked_, taken.unlooked_);
    return *this;
  }
  ~CodedWorld() = default;

  // Copies the bounds of a world of floats, in order, or of a list.
  explicit CodedWorld(const FloatView& floats)
      : codes_(floats), learnt_(floats.size) {
    records_.reserve(floats.size);
    for (std::size_t i = 0; i < floats.size; ++i) {
      records_.push_back(detail::BoundAt(floats, i));
    }
  }
  explicit CodedWorld(const World<FloatView>& floats)
      : CodedWorld(floats.view()) {}
  explicit CodedWorld(std::span<const Bound> bounds)
      : records_(bounds.begin(), bounds.end()) {
    Recode();
  }

  std::size_t size() const { return records_.size(); }
  bool empty() const { return records_.empty(); }

  // Appends and returns the object's index. Amortised O(1).
  std::size_t Push(const Bound& bound) {
    // All memory comes before any change, so that codes and floats stay in
    // step.
    if (size() == records_.capacity()) Reserve(std::max(kLeast, 2 * size()));
    if (unlooked_ == 0) LearnInTime();
    codes_.Push(bound);
    records_.push_back(bound);
    --unlooked_;
    return size() - 1;
  }
  void Set(std::size_t index, const Bound& bound) {
    codes_.CheckIndex(index, "CodedWorld::Set");
    codes_.Set(index, bound);
    records_[index] = bound;
  }
  Bound Get(std::size_t index) const {
    codes_.CheckIndex(index, "CodedWorld::Get");
    return records_[index];
  }
  // Removes object `index`; the last object takes its place. O(1).
  void EraseBySwap(std::size_t index) {
    codes_.CheckIndex(index, "CodedWorld::EraseBySwap");
    codes_.EraseBySwap(index);
    records_[index] = records_.back();
    records_.pop_back();
  }
  // Room for so many objects in all. To learn takes memory of its own.
  void Reserve(std::size_t objects) {
    codes_.Reserve(objects);
    records_.reserve(objects);
  }
  // Keeps the memory, and the map until there is enough to learn a new one.
  void Clear() {
    codes_.Clear();
    records_.clear();
    learnt_ = 0;
    unlooked_ = 0;
  }

  // As in Codes: O(1), and O(size).
  bool Fits() const { return codes_.Fits(); }
  void Recode() {
    codes_.Recode(std::span<const Bound>(records_));
    learnt_ = size();
    unlooked_ = 0;
  }

  // For calls on codes alone.
  const Codes<FloatView, CodeType>& codes() const { return codes_; }

  View view() const { return {codes_.view(), records_}; }

 private:
  static constexpr std::size_t kLeast = 64;

  // Learns if it is time, and says when to look again. After it has learnt
  // there is room for an eighth more at least, so that a Push is O(1) all told.
  void LearnInTime() {
    if (size() < kLeast) {
      unlooked_ = kLeast - size();
      return;
    }
    std::size_t room = size() < 2 * learnt_ ? codes_.view().planes().Room() : 0;
    if (room < size() / 16) {
      Recode();
      room = codes_.view().planes().Room();
    }
    unlooked_ = std::min(room, 2 * learnt_ - size());
  }

  Codes<FloatView, CodeType> codes_;
  std::vector<Bound, detail::BlockAllocator<Bound>> records_;
  std::size_t learnt_ = 0;    // objects that there were then
  std::size_t unlooked_ = 0;  // pushes until it is time to look at the map
};

}  // namespace halfspace

#endif  // HALFSPACE_CODES_H_
