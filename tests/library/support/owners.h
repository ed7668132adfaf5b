// Owning worlds, quantized bounds and quantized worlds as rows, for tests that
// are compiled once for all of them. A bound is a record of its values.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_OWNERS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_OWNERS_H_

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"
#include "tests/library/support/any_world.h"
#include "tests/library/support/dims.h"

namespace halfspace::testing {

using Record = std::array<std::byte, 80>;  // as many bytes as a bound has
using Records = std::vector<Record>;

template <typename T>
Record RecordOf(const T* values, std::size_t count) {
  Record record{};
  std::memcpy(record.data(), values, count * sizeof(T));
  return record;
}

class AnyOwner {
 public:
  virtual ~AnyOwner() = default;

  // What a call takes; without refining, if there is that.
  virtual AnyWorld seen() const = 0;
  virtual AnyWorld quantized() const = 0;
  // Quantized bounds, refined by a world of floats.
  virtual AnyWorld Refined(const AnyOwner& floats) const = 0;
  virtual bool Fits() const = 0;
  virtual const MemoryResource& memory() const = 0;
  virtual std::size_t size() const = 0;
  virtual bool empty() const = 0;
  virtual std::size_t capacity() const = 0;  // of worlds alone; or 0
  // False if it keeps no bounds.
  virtual bool Get(std::size_t i, Record& bound) const = 0;

  virtual std::size_t Push(const Record& bound) = 0;
  virtual void Set(std::size_t i, const Record& bound) = 0;
  virtual void EraseBySwap(std::size_t i) = 0;
  virtual void Reserve(std::size_t objects) = 0;
  virtual void Clear() = 0;
  virtual void Assign(const void* bounds, std::size_t count) = 0;
  virtual void Requantize(const AnyOwner& floats) = 0;

  // The operations of the owner itself: constructors, assignments, swap().
  virtual std::unique_ptr<AnyOwner> Copy() const = 0;
  virtual std::unique_ptr<AnyOwner> Copy(
      const MemoryResource& memory) const = 0;
  virtual std::unique_ptr<AnyOwner> Move() = 0;
  virtual void AssignCopy(const AnyOwner& other) = 0;
  virtual void AssignMove(AnyOwner& other) = 0;
  virtual void Swap(AnyOwner& other) = 0;
  virtual void StdSwap(AnyOwner& other) = 0;
};

using MakeOwner = std::unique_ptr<AnyOwner> (*)(const void* bounds,
                                                std::size_t count,
                                                const MemoryResource& memory);

struct OwnerRow {
  std::string name;
  std::string type;  // which errors name
  detail::PlaneLayout layout;
  bool is_double;
  MakeOwner make;
  MakeOwner make_floats;  // a world of floats of the same bounds

  bool IsQuantized() const { return type != "World"; }
  std::size_t record_bytes() const {
    return layout.plane_count * (is_double ? sizeof(double) : sizeof(float));
  }
  // As a list in memory.
  std::vector<std::byte> List(const Records& bounds) const;
  std::unique_ptr<AnyOwner> Make(const Records& bounds,
                                 const MemoryResource& memory = {}) const {
    return make(List(bounds).data(), bounds.size(), memory);
  }
  std::unique_ptr<AnyOwner> MakeFloats(const Records& bounds) const {
    return make_floats(List(bounds).data(), bounds.size(), {});
  }

  friend std::ostream& operator<<(std::ostream& out, const OwnerRow& row) {
    return out << row.name;
  }
};

std::vector<OwnerRow> OwnerRows();

// Bounds as floats, as quantized bounds, and as a quantized world.
struct AnyQuantized {
  AnyWorld floats() const { return its_floats->seen(); }
  AnyWorld quantized() const { return bounds->seen(); }
  AnyWorld refined() const { return bounds->Refined(*its_floats); }
  AnyWorld world() const { return its_world->seen(); }

  std::unique_ptr<AnyOwner> its_floats;
  std::unique_ptr<AnyOwner> bounds;
  std::unique_ptr<AnyOwner> its_world;
};

// A kind of quantized worlds.
struct QuantizedRow {
  std::string name;
  detail::PlaneLayout layout;
  std::size_t element_bytes;
  MakeOwner make_floats;
  MakeOwner make_bounds;
  MakeOwner make_world;

  std::size_t planes() const { return layout.plane_count; }
  bool IsMinPlane(std::size_t p) const { return p < layout.axes; }
  // Of the values of one bound after another.
  AnyQuantized Make(const std::vector<float>& values) const {
    const std::size_t count = values.size() / planes();
    return {make_floats(values.data(), count, {}),
            make_bounds(values.data(), count, {}),
            make_world(values.data(), count, {})};
  }
  friend std::ostream& operator<<(std::ostream& out, const QuantizedRow& row) {
    return out << row.name;
  }
};

// In all dimensions that the library has.
std::vector<QuantizedRow> AllQuantizedRows();

// In those that are tested.
[[maybe_unused]] static std::vector<QuantizedRow> QuantizedRows() {
  return InDims(TestDims(), AllQuantizedRows());
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_OWNERS_H_
