// Quantized worlds: bounds as quantized bounds of one or two bytes a plane, to
// be tested at a quarter or half of the bytes, and so up to four times as fast.
//
// A test made of compares alone survives any monotone map of both its sides: a
// pair that floats do not reject is not rejected by quantized bounds either. A
// level is the rank of a value among quantiles of its plane, so that each plane
// rejects as much as its bits can, wherever the objects are; outliers cost
// nothing.
//
//   QuantizedBounds  those of floats that the caller keeps
//   Refined          such bounds and those floats: the exact answer
//   QuantizedWorld   a world that owns both, and keeps them in step
//
// All of them are worlds to the calls of reject.h and reject_many.h, with the
// queries of the floats.
//   Quantized bounds alone answer conservatively: they reject no pair that the
//   floats keep, and keep some that the floats reject; a few times as many
//   survivors with uint8 quantized bounds, a few in a thousand with uint16.
//   Refined and QuantizedWorld test what the quantized bounds leave on the
//   floats too: the answer is that of the floats, bit for bit.
//
// Memory: planes x sizeof(Element) bytes an object (an AABO in 3D: 8 or 16),
// and at most 1.4 KiB (uint8) or 257 KiB (uint16) a plane for the map.
//
// Special values: a NaN plane never rejects, infinities and Everything() are
// values like others. One object, equal objects, constant planes: conservative
// like all. Subnormals are quantized as 0, so that a caller's DAZ mode changes
// nothing. Floats are quantized as integers, and trap no floating-point
// exception; to train a map, and Fits(), may give inexact numbers, and what
// refines quantized bounds is as in reject.h.
//
// Thread safety: as for any container. Source: monotone quantized bounds are
// this library's; docs/performance.md has the figures.
#ifndef HALFSPACE_QUANTIZED_H_
#define HALFSPACE_QUANTIZED_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/detail/block_memory.h"
#include "halfspace/detail/quantized_scan.h"
#include "halfspace/detail/quantizer.h"
#include "halfspace/span.h"
#include "halfspace/world.h"

namespace halfspace {

// The quantized bounds of the bounds of a world of floats. FloatView is
// SimplexView<D>, AabbView<D> or AaboView<D>; Element is std::uint8_t or
// std::uint16_t.
//
// The map is trained from the bounds there are (Requantize), and then kept:
// bounds that are set or pushed are quantized by it, whatever their values.
// When they have moved so far that it does not tell them apart well, Fits()
// says so, and it is time for Requantize again. Answers are right all the
// while.
//
// Errors (error.h): an index that is not below size() throws
// std::invalid_argument; memory that cannot be had throws std::bad_alloc and a
// size that cannot exist std::invalid_argument, and the quantized bounds are as
// they were.
template <typename FloatView, typename ElementType = std::uint8_t>
class QuantizedBounds {
  static_assert(
      std::is_same_v<typename FloatView::Bound::Scalar, float>,
      "quantized bounds are made from worlds of floats, not of doubles");

 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Element = ElementType;
  using View = detail::QuantizedView<FloatView, ElementType>;

  // None, and a map that has one level for everything: what is pushed survives
  // every query that is not empty, until Requantize.
  QuantizedBounds() = default;

  // Quantized bounds the bounds of `floats`.
  explicit QuantizedBounds(const FloatView& floats) { Requantize(floats); }
  explicit QuantizedBounds(const World<FloatView>& floats) {
    Requantize(floats);
  }

  std::size_t size() const { return planes_.size(); }
  bool empty() const { return size() == 0; }

  // Trains a new map from `floats` and quantized bounds all of them: about 0.1
  // us an octahedron (0.3 with uint16), and a sort of at most 2^16 values a
  // plane (2^18 with uint16). Throws std::invalid_argument for a null or
  // misaligned plane of a view that is not empty; the quantized bounds are as
  // they were then.
  void Requantize(const FloatView& floats) {
    planes_.Requantize(detail::ColumnsOf(floats));
  }
  void Requantize(const World<FloatView>& floats) { Requantize(floats.view()); }

  // The same for bounds in a list.
  void Requantize(Span<const Bound> bounds) {
    planes_.Requantize(detail::ColumnsOf(bounds));
  }

  // Whether the map still tells the bounds apart about as well as when it was
  // trained, judged by 1024 of them. False after pushes to an empty map. O(1).
  bool Fits() const { return planes_.Fits(); }

  // As in World, for the quantized bounds: keep them in step with the floats.
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

  // For the calls. Valid until the quantized bounds change.
  View view() const { return View(planes_); }

 private:
  detail::QuantizedPlanes<detail::StoredElement<ElementType>> planes_{
      Bound::kAxes, detail::kPlaneCount<Bound> - Bound::kAxes};
};

// Quantized bounds and the floats they were made from, in the same order: a
// world whose answers are those of the floats. The calls throw
// std::invalid_argument if the sizes differ; floats other than those that were
// quantized are an error that cannot be seen, and falsely reject. Both must
// outlive it.
template <typename FloatView, typename ElementType>
detail::RefinedView<FloatView, ElementType, FloatView> Refined(
    const QuantizedBounds<FloatView, ElementType>& quantized,
    const FloatView& floats) {
  return {quantized.view(), floats};
}
template <typename FloatView, typename ElementType>
detail::RefinedView<FloatView, ElementType, FloatView> Refined(
    const QuantizedBounds<FloatView, ElementType>& quantized,
    const World<FloatView>& floats) {
  return {quantized.view(), floats.view()};
}

// A world that owns its quantized bounds and its floats: those are as many
// bytes again as in a World. Errors are those of Quantized bounds, and the
// world is as it was.
//
// The world trains a map when it is made of bounds. Pushed to, it trains a new
// one when it has twice the objects that it trained from, and before those that
// came, in the order of a plane, say, crowd a few quantized bounds; pushed to
// from nothing, and after Clear(), for the first time at 64. So Fits() holds
// while objects are pushed, from then on. What Set and EraseBySwap change, a
// Push later may train; ask Fits() whether to call Requantize().
//
// To set an object takes about 0.1 us; to push one, all told, 0.3 to 1 us
// (three times that in the order of a plane), for most of it is training.
//
// Its floats are records, one after another, and not planes: few of them are
// looked at, and each is then one cache line instead of one for each plane.
template <typename FloatView, typename ElementType = std::uint8_t>
class QuantizedWorld {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Element = ElementType;
  using View = detail::RefinedView<FloatView, ElementType, Span<const Bound>>;

  QuantizedWorld() = default;
  QuantizedWorld(const QuantizedWorld& other) = default;
  QuantizedWorld(QuantizedWorld&& other) noexcept  // leaves it empty
      : quantized_(std::move(other.quantized_)),
        records_(std::move(other.records_)),
        trained_(std::exchange(other.trained_, 0)),
        pushes_left_(std::exchange(other.pushes_left_, 0)) {}
  QuantizedWorld& operator=(const QuantizedWorld& other) {
    return *this = QuantizedWorld(other);
  }
  QuantizedWorld& operator=(QuantizedWorld&& other) noexcept {
    QuantizedWorld taken(std::move(other));
    std::swap(quantized_, taken.quantized_);
    records_.swap(taken.records_);
    std::swap(trained_, taken.trained_);
    std::swap(pushes_left_, taken.pushes_left_);
    return *this;
  }
  ~QuantizedWorld() = default;

  // Copies the bounds of a world of floats, in order, or of a list.
  explicit QuantizedWorld(const FloatView& floats)
      : quantized_(floats), trained_(floats.size) {
    records_.reserve(floats.size);
    for (std::size_t i = 0; i < floats.size; ++i) {
      records_.push_back(detail::BoundAt(floats, i));
    }
  }
  explicit QuantizedWorld(const World<FloatView>& floats)
      : QuantizedWorld(floats.view()) {}
  explicit QuantizedWorld(Span<const Bound> bounds)
      : records_(bounds.begin(), bounds.end()) {
    Requantize();
  }

  std::size_t size() const { return records_.size(); }
  bool empty() const { return records_.empty(); }

  // Appends and returns the object's index. Amortised O(1).
  std::size_t Push(const Bound& bound) {
    // All memory comes before any change, so that quantized bounds and floats
    // stay in step.
    if (size() == records_.capacity()) Reserve(std::max(kLeast, 2 * size()));
    if (pushes_left_ == 0) TrainIfDue();
    quantized_.Push(bound);
    records_.push_back(bound);
    --pushes_left_;
    return size() - 1;
  }
  void Set(std::size_t index, const Bound& bound) {
    quantized_.CheckIndex(index, "QuantizedWorld::Set");
    quantized_.Set(index, bound);
    records_[index] = bound;
  }
  Bound Get(std::size_t index) const {
    quantized_.CheckIndex(index, "QuantizedWorld::Get");
    return records_[index];
  }
  // Removes object `index`; the last object takes its place. O(1).
  void EraseBySwap(std::size_t index) {
    quantized_.CheckIndex(index, "QuantizedWorld::EraseBySwap");
    quantized_.EraseBySwap(index);
    records_[index] = records_.back();
    records_.pop_back();
  }
  // Room for so many objects in all. To train takes memory of its own.
  void Reserve(std::size_t objects) {
    quantized_.Reserve(objects);
    records_.reserve(objects);
  }
  // Keeps the memory, and the map until there is enough to train a new one.
  void Clear() {
    quantized_.Clear();
    records_.clear();
    trained_ = 0;
    pushes_left_ = 0;
  }

  // As in Quantized bounds: O(1), and O(size).
  bool Fits() const { return quantized_.Fits(); }
  void Requantize() {
    quantized_.Requantize(Span<const Bound>(records_));
    trained_ = size();
    pushes_left_ = 0;
  }

  // For calls on quantized bounds alone.
  const QuantizedBounds<FloatView, ElementType>& quantized() const {
    return quantized_;
  }

  View view() const { return {quantized_.view(), records_}; }

 private:
  static constexpr std::size_t kLeast = 64;

  // Trains if it is time, and says when to look again. After it has trained
  // there is room for an eighth more at least, so that a Push is O(1) all told.
  void TrainIfDue() {
    if (size() < kLeast) {
      pushes_left_ = kLeast - size();
      return;
    }
    std::size_t room =
        size() < 2 * trained_ ? quantized_.view().planes().Room() : 0;
    if (room < size() / 16) {
      Requantize();
      room = quantized_.view().planes().Room();
    }
    pushes_left_ = std::min(room, 2 * trained_ - size());
  }

  QuantizedBounds<FloatView, ElementType> quantized_;
  std::vector<Bound, detail::BlockAllocator<Bound>> records_;
  std::size_t trained_ = 0;      // objects that there were then
  std::size_t pushes_left_ = 0;  // pushes until it is time to look at the map
};

}  // namespace halfspace

#endif  // HALFSPACE_QUANTIZED_H_
