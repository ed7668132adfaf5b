// Quantized bounds: one or two bytes per plane instead of four. A test reads a
// quarter or half of the bytes and is up to four times as fast.
//
//   halfspace::QuantizedWorld<halfspace::AaboView3> world(bounds);
//   const std::size_t n = halfspace::CountSurvivors(world, query);  // reject.h
//
//   QuantizedBounds  quantized bounds; the caller keeps the floats
//   Refined          a view of quantized bounds and their floats: exact results
//   QuantizedWorld   a world that owns both, and changes both together
//
// All three are worlds for the calls of reject.h and reject_many.h. Queries are
// the same as for floats. Each call encodes its queries.
//
// QuantizedBounds alone are a filter. They never reject an object that the
// floats keep. They keep some objects that the floats reject. With uint8 a few
// times as many objects survive as with floats. With uint16 there are a few in
// a thousand more. Refined and QuantizedWorld test the survivors of the filter
// on the floats too. Their results are those of the floats, bit for bit.
//
// Why no overlap is missed: a float is encoded as its rank among quantiles of
// its plane. This map keeps the order of floats, and a test consists only of
// compares. So an object that the floats keep is kept by the ranks too. The
// objects are spread evenly over the ranks, so outliers cost no precision.
//
// A NaN in a plane never rejects. Infinities and Everything() are encoded like
// any other value. Subnormals are encoded as 0, so the DAZ mode of the caller
// does not change an encoded value.
//
// Thread safety: as for any container. Source: quantization by monotone maps is
// this library's own; docs/performance.md has the figures.
#ifndef HALFSPACE_QUANTIZED_H_
#define HALFSPACE_QUANTIZED_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/detail/quantized.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"
#include "halfspace/world.h"

namespace halfspace {

// Quantized bounds of a world of floats. FloatView is SimplexView<D>,
// AabbView<D> or AaboView<D>. ElementType is std::uint8_t or std::uint16_t.
//
// Requantize trains the quantizer on the given bounds and encodes them. Push
// and Set use the same quantizer for any values. When the bounds have moved so
// far that the quantizer no longer separates them well, Fits() returns false.
// Then call Requantize again. Until then the filter is still correct, but more
// objects survive it.
//
// Memory: an object takes `planes * sizeof(ElementType)` bytes (an AABO in 3D
// takes 8 or 16). The quantizer takes at most 1.4 KiB (uint8) or 257 KiB
// (uint16) per plane. During Requantize, both exist twice, and a sample takes
// at most about 0.5 MiB (uint8) or 2 MiB (uint16) more. All of it comes from
// the heap or from the caller's resource. memory.h says which resource copies,
// moves and swap(a, b) use.
//
// Errors (error.h): an index must be less than size(). A size must fit the
// address space. The pointer of a list with elements, and of a plane of a view
// with objects, must not be null or misaligned. A failed allocation throws
// std::bad_alloc. After an error the quantized bounds are unchanged.
//
// Floating-point mode: encoding uses integers only, and never traps. Requantize
// and Fits can raise the inexact exception.
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

  // Creates quantized bounds without objects. The quantizer has only one level
  // (quantized value), so every object survives every query until the first
  // Requantize.
  QuantizedBounds() : QuantizedBounds(MemoryResource()) {}
  explicit QuantizedBounds(const MemoryResource& memory)
      : planes_(detail::kLayoutOf<Bound>, sizeof(Element), memory) {}

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

  // Replaces all objects: trains a new quantizer on `floats` and encodes them.
  //
  // Errors: unless `floats` is empty, its planes must not be null or
  // misaligned.
  //
  // Cost: about 0.1 us per octahedron (0.3 us with uint16), and a sort of at
  // most 2^16 values per plane (2^18 with uint16).
  void Requantize(const FloatView& floats) {
    planes_.Requantize(detail::ColumnsOf(floats));
  }
  void Requantize(const World<FloatView>& floats) { Requantize(floats.view()); }

  // As Requantize() of a view, for an array of bounds.
  void Requantize(Span<const Bound> bounds) {
    planes_.Requantize(detail::ColumnsOf(bounds));
  }

  // Returns whether the quantizer still separates the bounds about as well as
  // after training. The call looks at a sample of 1024 bounds. Returns false if
  // bounds were pushed and the quantizer was never trained. O(1).
  bool Fits() const { return planes_.Fits(); }

  // As in World (world.h). The caller makes the same change to the floats.
  std::size_t Push(const Bound& bound) {
    return planes_.Push(detail::Planes(bound));
  }
  void Set(std::size_t index, const Bound& bound) {
    planes_.Set(index, detail::Planes(bound));
  }
  void EraseBySwap(std::size_t index) { planes_.EraseBySwap(index); }
  void Reserve(std::size_t objects) { planes_.Reserve(objects); }

  // Removes all objects. Keeps the memory and the quantizer.
  void Clear() { planes_.Clear(); }

  // Throws (error.h) if `index` is not less than size(). The message names
  // `call` as the call that failed.
  void CheckIndex(std::size_t index, const char* call) const {
    planes_.CheckIndex(index, call);
  }

  // Returns a view for the calls of reject.h and reject_many.h. Valid until the
  // quantized bounds change.
  View view() const { return View(planes_); }

 private:
  template <typename, typename>
  friend class QuantizedWorld;

  detail::QuantizedPlanes planes_;
};

// Returns a view of quantized bounds and of the floats from which they were
// encoded, in the same order. Its results are those of the floats. Both must
// outlive the view.
//
// Errors: a call on the view throws (error.h) if the sizes differ. No call can
// detect floats with different values. Overlaps can then be missed.
//
// Floating-point mode: as in reject.h for the floats.
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

// A world that owns quantized bounds and their floats. Its results are those of
// the floats.
//
// Training: a world that is created from bounds trains its quantizer on them. A
// Push into a world of at least 64 objects trains a new one if the world has
// twice as many objects as at the last training. It trains earlier if the new
// objects would share too few levels, as objects sorted along an axis do. So
// Fits() is true from 64 objects on if objects are only pushed. Set and
// EraseBySwap do not train, but a later Push may. After many of these calls,
// check Fits() and call Requantize().
//
// Memory: the floats take as many bytes as in a World, in addition to the
// memory of QuantizedBounds. They are stored as an array of bounds, not as
// planes. A query reads the floats of only a few objects. As a bound, an object
// is in one or two cache lines. As planes, it would be in one for each plane.
//
// Errors, floating-point mode: as QuantizedBounds, and as in reject.h for the
// floats. After an error the world is unchanged.
//
// Cost: with uint8 Set takes 0.1 to 0.4 us, depending on whether the object is
// in the caches. Push takes 0.3 to 1 us on average, most of it training, and
// two to three times as much for objects sorted along an axis.
template <typename FloatView, typename ElementType = std::uint8_t>
class QuantizedWorld {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Element = ElementType;
  using View = detail::RefinedView<FloatView, ElementType, Span<const Bound>>;

  QuantizedWorld() : QuantizedWorld(MemoryResource()) {}
  explicit QuantizedWorld(const MemoryResource& memory)
      : quantized_(memory), records_(memory) {}
  QuantizedWorld(const QuantizedWorld& other)
      : QuantizedWorld(other, MemoryResource()) {}
  QuantizedWorld(const QuantizedWorld& other, const MemoryResource& memory)
      : quantized_(other.quantized_, memory),
        records_(other.records_, memory),
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
    swap(a.records_, b.records_);
    std::swap(a.trained_, b.trained_);
    std::swap(a.pushes_left_, b.pushes_left_);
  }

  // Copies the bounds of a world of floats or of an array, in order.
  explicit QuantizedWorld(const FloatView& floats,
                          const MemoryResource& memory = {})
      : quantized_(floats, memory), records_(memory), trained_(floats.size) {
    records_.Reserve(floats.size);
    for (std::size_t i = 0; i < floats.size; ++i) {
      records_.Push(detail::BoundAt(floats, i));
    }
  }
  explicit QuantizedWorld(const World<FloatView>& floats,
                          const MemoryResource& memory = {})
      : QuantizedWorld(floats.view(), memory) {}
  explicit QuantizedWorld(Span<const Bound> bounds,
                          const MemoryResource& memory = {})
      : quantized_(memory), records_(memory), trained_(bounds.size()) {
    quantized_.Requantize(bounds);
    records_.Reserve(bounds.size());
    for (const Bound& bound : bounds) records_.Push(bound);
  }

  const MemoryResource& memory() const { return quantized_.memory(); }
  std::size_t size() const { return records_.size(); }
  bool empty() const { return size() == 0; }

  // Appends an object and returns its index. Can train. Amortized O(1).
  std::size_t Push(const Bound& bound) {
    // Allocates before it changes anything, so that quantized bounds and floats
    // still match if an allocation fails.
    if (size() == records_.capacity()) {
      Reserve(size() < kLeast / 2 ? kLeast : 2 * size());
    }
    if (pushes_left_ == 0) TrainIfDue();
    quantized_.Push(bound);
    records_.Push(bound);
    --pushes_left_;
    return size() - 1;
  }
  // Replaces the bound of object `index`. O(1).
  void Set(std::size_t index, const Bound& bound) {
    quantized_.CheckIndex(index, "QuantizedWorld::Set");
    quantized_.Set(index, bound);
    records_[index] = bound;
  }
  // Returns the bound of object `index`. O(1).
  Bound Get(std::size_t index) const {
    quantized_.CheckIndex(index, "QuantizedWorld::Get");
    return records_[index];
  }
  // Removes object `index` and moves the last object to its place. O(1).
  void EraseBySwap(std::size_t index) {
    quantized_.CheckIndex(index, "QuantizedWorld::EraseBySwap");
    quantized_.EraseBySwap(index);
    records_.EraseBySwap(index);
  }
  // Allocates room for `objects` objects in total. Training allocates more
  // memory.
  void Reserve(std::size_t objects) {
    quantized_.Reserve(objects);
    records_.Reserve(objects);
  }
  // Removes all objects. Keeps the memory, and keeps the quantizer until Push
  // trains a new one.
  void Clear() {
    quantized_.Clear();
    records_.Clear();
    trained_ = 0;
    pushes_left_ = 0;
  }

  // As QuantizedBounds::Fits(). O(1).
  bool Fits() const { return quantized_.Fits(); }
  // Trains a new quantizer on the objects and encodes them again. O(size).
  void Requantize() {
    quantized_.Requantize(Span<const Bound>(records_));
    trained_ = size();
    pushes_left_ = 0;
  }

  // Returns the quantized bounds alone, for calls that need only the filter.
  const QuantizedBounds<FloatView, ElementType>& quantized() const {
    return quantized_;
  }

  View view() const { return {quantized_.view(), records_}; }

 private:
  static constexpr std::size_t kLeast = 64;

  // Trains if it is time, and sets when to check again. After training, at
  // least an eighth as many objects fit, so Push is O(1) on average.
  void TrainIfDue() {
    if (size() < kLeast) {
      pushes_left_ = kLeast - size();
      return;
    }
    std::size_t room = size() < 2 * trained_ ? quantized_.planes_.Room() : 0;
    if (room < size() / 16) {
      Requantize();
      room = quantized_.planes_.Room();
    }
    const std::size_t until_twice = 2 * trained_ - size();
    pushes_left_ = room < until_twice ? room : until_twice;
  }

  QuantizedBounds<FloatView, ElementType> quantized_;
  detail::BoundArray<Bound> records_;
  std::size_t trained_ = 0;      // objects at the last training
  std::size_t pushes_left_ = 0;  // until TrainIfDue checks again
};

}  // namespace halfspace

#endif  // HALFSPACE_QUANTIZED_H_
