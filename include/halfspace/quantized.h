// Quantized bounds: one or two bytes a plane instead of four. A test reads a
// quarter or half of the bytes, and is up to four times as fast.
//
//   QuantizedBounds  quantized bounds of floats that the caller keeps
//   Refined          a view of both, quantized bounds and floats: exact answers
//   QuantizedWorld   a world that owns both and keeps them in step
//
// All of them are worlds to the calls of reject.h and reject_many.h. Queries
// are those of the floats; a call encodes them.
//
// Filter and refine. QuantizedBounds alone are a filter: they never reject a
// pair that the floats keep, and keep some that the floats reject (a few times
// as many survivors with uint8, a few in a thousand more with uint16). Refined
// and QuantizedWorld test the survivors of the filter on the floats too, so
// their answer is that of the floats, bit for bit.
//
// Why it is safe: a float is encoded as its rank among quantiles of its plane.
// That map is monotone, and a test consists of compares alone, so a pair that
// the floats keep is kept by the ranks too. Ranks spread the bits evenly over
// the objects, wherever those are, so outliers cost nothing.
//
// Memory: planes x sizeof(Element) bytes an object (an AABO in 3D: 8 or 16),
// and at most 1.4 KiB (uint8) or 257 KiB (uint16) a plane for the quantizer.
// Requantize needs both twice during the call, and at most 0.5 MiB (uint8) or
// 2 MiB (uint16) for a sample. All of it comes from the heap or from a resource
// of the caller's; memory.h says which one copies, moves and swap(a, b) use.
//
// Special values: a NaN plane never rejects. Infinities and Everything() are
// values like others. One object, equal objects and constant planes are tested
// conservatively, like everything else. Subnormals are encoded as 0, so that a
// caller's DAZ mode changes nothing.
//
// Floating-point exceptions: floats are encoded as integers, which traps none.
// Training and Fits() may raise the inexact exception. Refining is as in
// reject.h.
//
// Thread safety: as for any container. Source: quantization by monotone maps is
// this library's own; docs/performance.md has the figures.
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
#include "halfspace/memory.h"
#include "halfspace/span.h"
#include "halfspace/world.h"

namespace halfspace {

// Quantized bounds of a world of floats. FloatView is SimplexView<D>,
// AabbView<D> or AaboView<D>; Element is std::uint8_t or std::uint16_t.
//
// Requantize trains the quantizer on the bounds it is given and encodes them.
// The quantizer is kept afterwards: it encodes all bounds that are pushed or
// set, whatever their values. When these have moved so far that it no longer
// tells them apart well, Fits() returns false: call Requantize again. Answers
// are right before and after; only the number of survivors changes.
//
// Errors (error.h): an index is not below size(), no memory can have the size,
// or a plane of a view or the pointer of a list of bounds is null or misaligned
// and the view or the list is not empty. A failed allocation throws
// std::bad_alloc. The quantized bounds are then as they were.
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

  // No bounds, and a quantizer with one level for every value: until
  // Requantize, what is pushed survives every query that is not empty.
  QuantizedBounds() : QuantizedBounds(MemoryResource()) {}
  explicit QuantizedBounds(const MemoryResource& memory)
      : planes_(Bound::kAxes, detail::kPlaneCount<Bound> - Bound::kAxes,
                memory) {}

  // Trains a quantizer on `floats` and encodes them.
  explicit QuantizedBounds(const FloatView& floats,
                           const MemoryResource& memory = {})
      : QuantizedBounds(memory) {
    Requantize(floats);
  }
  explicit QuantizedBounds(const World<FloatView>& floats,
                           const MemoryResource& memory = {})
      : QuantizedBounds(floats.view(), memory) {}

  QuantizedBounds(const QuantizedBounds& other, const MemoryResource& memory)
      : planes_(other.planes_, memory) {}

  friend void swap(QuantizedBounds& a, QuantizedBounds& b) noexcept {
    swap(a.planes_, b.planes_);
  }

  const MemoryResource& memory() const { return planes_.memory(); }
  std::size_t size() const { return planes_.size(); }
  bool empty() const { return size() == 0; }

  // Replaces the content: trains a new quantizer on `floats` and encodes all of
  // them. Costs about 0.1 us an octahedron (0.3 with uint16), and a sort of at
  // most 2^16 values a plane (2^18 with uint16).
  void Requantize(const FloatView& floats) {
    planes_.Requantize(detail::ColumnsOf(floats));
  }
  void Requantize(const World<FloatView>& floats) { Requantize(floats.view()); }

  // The same for a list of bounds.
  void Requantize(Span<const Bound> bounds) {
    planes_.Requantize(detail::ColumnsOf(bounds));
  }

  // Whether the quantizer still tells the bounds apart about as well as when it
  // was trained, judged by 1024 of them. False if bounds were pushed and it was
  // never trained. O(1).
  bool Fits() const { return planes_.Fits(); }

  // As in World. The caller makes the same change to the floats.
  std::size_t Push(const Bound& bound) {
    return planes_.Push(detail::Planes(bound));
  }
  void Set(std::size_t index, const Bound& bound) {
    planes_.Set(index, detail::Planes(bound));
  }
  void EraseBySwap(std::size_t index) { planes_.EraseBySwap(index); }
  void Reserve(std::size_t objects) { planes_.Reserve(objects); }

  // Removes all objects; keeps the memory and the quantizer.
  void Clear() { planes_.Clear(); }

  // Throws (error.h), in the name of `call`, unless `index` is
  // below size().
  void CheckIndex(std::size_t index, const char* call) const {
    planes_.CheckIndex(index, call);
  }

  // For the calls. Valid until the quantized bounds change.
  View view() const { return View(planes_); }

 private:
  detail::QuantizedPlanes<detail::StoredElement<ElementType>> planes_;
};

// A world of quantized bounds and of the floats that they were encoded from, in
// the same order. Its answers are those of the floats. Both must outlive it.
//   The calls throw (error.h) if the sizes differ. Different floats
//   cannot be detected: a call may then reject pairs that touch.
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

// A world that owns quantized bounds and their floats. The floats take as many
// bytes as in a World. Errors are those of QuantizedBounds; the world is then
// as it was.
//
// Training: a world that is constructed from bounds trains its quantizer on
// them. Push trains a new one when the world has twice the objects of the last
// training, and earlier if the objects pushed since would crowd into a few
// levels, as objects sorted along an axis do. A world that starts empty, or was
// cleared, is trained for the first time at 64 objects. So from 64 objects on
// Fits() is true while objects are only pushed. Set and EraseBySwap do not
// train; a later Push may. After many of them, check Fits() and call
// Requantize().
//
// Cost: Set takes about 0.1 us. Push takes 0.3 to 1 us on average, most of it
// training, and three times that for objects sorted along an axis.
//
// The floats are stored as records, one after another, and not as planes: few
// of them are read, and reading a record misses one cache line instead of one
// for each plane.
template <typename FloatView, typename ElementType = std::uint8_t>
class QuantizedWorld {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Element = ElementType;
  using View = detail::RefinedView<FloatView, ElementType, Span<const Bound>>;

  QuantizedWorld() : QuantizedWorld(MemoryResource()) {}
  explicit QuantizedWorld(const MemoryResource& memory)
      : quantized_(memory), records_(Allocator(memory)) {}
  QuantizedWorld(const QuantizedWorld& other)
      : QuantizedWorld(other, MemoryResource()) {}
  QuantizedWorld(const QuantizedWorld& other, const MemoryResource& memory)
      : quantized_(other.quantized_, memory),
        records_(other.records_, Allocator(memory)),
        trained_(other.trained_),
        pushes_left_(other.pushes_left_) {}
  QuantizedWorld(QuantizedWorld&& other) noexcept  // leaves it empty
      : quantized_(std::move(other.quantized_)),
        records_(std::move(other.records_)),
        trained_(std::exchange(other.trained_, 0)),
        pushes_left_(std::exchange(other.pushes_left_, 0)) {}
  QuantizedWorld& operator=(const QuantizedWorld& other) {
    return detail::AssignCopy(*this, other);
  }
  QuantizedWorld& operator=(QuantizedWorld&& other) {
    return detail::AssignMove(*this, other);
  }
  ~QuantizedWorld() = default;
  friend void swap(QuantizedWorld& a, QuantizedWorld& b) noexcept {
    swap(a.quantized_, b.quantized_);
    a.records_.swap(b.records_);
    std::swap(a.trained_, b.trained_);
    std::swap(a.pushes_left_, b.pushes_left_);
  }

  // Copies the bounds of a world of floats, in order, or of a list.
  explicit QuantizedWorld(const FloatView& floats,
                          const MemoryResource& memory = {})
      : quantized_(floats, memory),
        records_(Allocator(memory)),
        trained_(floats.size) {
    records_.reserve(floats.size);
    for (std::size_t i = 0; i < floats.size; ++i) {
      records_.push_back(detail::BoundAt(floats, i));
    }
  }
  explicit QuantizedWorld(const World<FloatView>& floats,
                          const MemoryResource& memory = {})
      : QuantizedWorld(floats.view(), memory) {}
  explicit QuantizedWorld(Span<const Bound> bounds,
                          const MemoryResource& memory = {})
      : quantized_(memory),
        records_(Allocator(memory)),
        trained_(bounds.size()) {
    quantized_.Requantize(bounds);
    records_.assign(bounds.begin(), bounds.end());
  }

  const MemoryResource& memory() const { return quantized_.memory(); }
  std::size_t size() const { return records_.size(); }
  bool empty() const { return records_.empty(); }

  // Appends and returns the object's index. Amortised O(1).
  std::size_t Push(const Bound& bound) {
    // Allocates before it changes anything, so that quantized bounds and floats
    // stay in step if that fails.
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
  // Makes room for `objects` objects in all. Training allocates more memory.
  void Reserve(std::size_t objects) {
    quantized_.Reserve(objects);
    records_.reserve(objects);
  }
  // Removes all objects. Keeps the memory, and the quantizer until there are
  // enough objects to train a new one.
  void Clear() {
    quantized_.Clear();
    records_.clear();
    trained_ = 0;
    pushes_left_ = 0;
  }

  // As in QuantizedBounds. Fits() is O(1), Requantize() is O(size).
  bool Fits() const { return quantized_.Fits(); }
  void Requantize() {
    quantized_.Requantize(Span<const Bound>(records_));
    trained_ = size();
    pushes_left_ = 0;
  }

  // The quantized bounds alone, for calls that need no refining.
  const QuantizedBounds<FloatView, ElementType>& quantized() const {
    return quantized_;
  }

  View view() const { return {quantized_.view(), records_}; }

 private:
  using Allocator = detail::BlockAllocator<Bound>;
  static constexpr std::size_t kLeast = 64;

  // Trains if it is time, and sets when to check again. After training there is
  // room for an eighth more objects at least, so Push is O(1) on average.
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
  std::vector<Bound, Allocator> records_;
  std::size_t trained_ = 0;      // objects at the last training
  std::size_t pushes_left_ = 0;  // until TrainIfDue checks again
};

}  // namespace halfspace

#endif  // HALFSPACE_QUANTIZED_H_
