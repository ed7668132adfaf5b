#include "tests/library/support/owners.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

#include "halfspace/quantized.h"
#include "halfspace/world.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {
namespace {

template <typename Owner>
constexpr bool kIsWorld = requires(Owner owner) {
  owner.planes();
};
template <typename Owner>
constexpr bool kIsQuantizedWorld = requires(Owner owner) {
  owner.quantized();
};

template <typename Owner>
class OwnerOf : public AnyOwner {
 public:
  using Bound = typename Owner::Bound;
  using Bounds = Span<const Bound>;

  explicit OwnerOf(Owner&& owner) : owner_(std::move(owner)) {}

  AnyWorld seen() const override { return AnyWorld(owner_); }
  AnyWorld quantized() const override {
    if constexpr (kIsQuantizedWorld<Owner>) {
      return AnyWorld(owner_.quantized());
    } else {
      return AnyWorld(owner_);
    }
  }
  AnyWorld Refined(const AnyOwner& floats) const override {
    if constexpr (!kIsWorld<Owner> && !kIsQuantizedWorld<Owner>) {
      return AnyWorld(halfspace::Refined(owner_, FloatsOf(floats)));
    } else {
      return seen();
    }
  }
  bool Fits() const override {
    if constexpr (kIsWorld<Owner>) {
      return true;
    } else {
      return owner_.Fits();
    }
  }
  const MemoryResource& memory() const override { return owner_.memory(); }
  std::size_t size() const override { return owner_.size(); }
  bool empty() const override { return owner_.empty(); }
  std::size_t capacity() const override {
    if constexpr (kIsWorld<Owner>) {
      return owner_.capacity();
    } else {
      return 0;
    }
  }
  bool Get(std::size_t i, Record& bound) const override {
    if constexpr (kIsWorld<Owner> || kIsQuantizedWorld<Owner>) {
      const Bound its = owner_.Get(i);
      std::memcpy(bound.data(), &its, sizeof(its));
      return true;
    } else {
      return false;
    }
  }

  std::size_t Push(const Record& bound) override {
    return owner_.Push(BoundOf(bound));
  }
  void Set(std::size_t i, const Record& bound) override {
    owner_.Set(i, BoundOf(bound));
  }
  void EraseBySwap(std::size_t i) override { owner_.EraseBySwap(i); }
  void Reserve(std::size_t objects) override { owner_.Reserve(objects); }
  void Clear() override { owner_.Clear(); }
  void Assign(const void* bounds, std::size_t count) override {
    const Bounds list(static_cast<const Bound*>(bounds), count);
    if constexpr (kIsWorld<Owner>) {
      owner_.Assign(list);
    } else if constexpr (kIsQuantizedWorld<Owner>) {
      owner_ = Owner(list, owner_.memory());
    } else {
      owner_.Requantize(list);
    }
  }
  void Requantize(const AnyOwner& floats) override {
    if constexpr (kIsQuantizedWorld<Owner>) {
      owner_.Requantize();
    } else if constexpr (!kIsWorld<Owner>) {
      owner_.Requantize(FloatsOf(floats));
    }
  }

  std::unique_ptr<AnyOwner> Copy() const override { return New(Owner(owner_)); }
  std::unique_ptr<AnyOwner> Copy(const MemoryResource& memory) const override {
    return New(Owner(owner_, memory));
  }
  std::unique_ptr<AnyOwner> Move() override { return New(std::move(owner_)); }
  void AssignCopy(const AnyOwner& other) override {
    owner_ = static_cast<const OwnerOf&>(other).owner_;
  }
  void AssignMove(AnyOwner& other) override {
    owner_ = std::move(static_cast<OwnerOf&>(other).owner_);
  }
  void Swap(AnyOwner& other) override {
    swap(owner_, static_cast<OwnerOf&>(other).owner_);
  }
  void StdSwap(AnyOwner& other) override {
    std::swap(owner_, static_cast<OwnerOf&>(other).owner_);
  }

  static std::unique_ptr<AnyOwner> Make(const void* bounds, std::size_t count,
                                        const MemoryResource& memory) {
    if (bounds == nullptr && count == 0) return New(Owner(memory));
    const Bounds list(static_cast<const Bound*>(bounds), count);
    if constexpr (kIsWorld<Owner> || kIsQuantizedWorld<Owner>) {
      return New(Owner(list, memory));
    } else {
      Owner owner(memory);
      owner.Requantize(list);
      return New(std::move(owner));
    }
  }

  // Assignments copy if the resources differ.
  static_assert(!std::is_nothrow_copy_assignable_v<Owner> &&
                !std::is_nothrow_move_assignable_v<Owner> &&
                std::is_nothrow_move_constructible_v<Owner> &&
                std::is_nothrow_swappable_v<Owner>);

 private:
  template <typename Other>
  friend class OwnerOf;

  template <typename View, typename Element>
  static const World<View>& WorldFor(const QuantizedBounds<View, Element>&,
                                     const AnyOwner& floats) {
    return static_cast<const OwnerOf<World<View>>&>(floats).owner_;
  }
  const auto& FloatsOf(const AnyOwner& floats) const {
    return WorldFor(owner_, floats);
  }
  static std::unique_ptr<AnyOwner> New(Owner&& owner) {
    return std::make_unique<OwnerOf>(std::move(owner));
  }
  static Bound BoundOf(const Record& record) {
    Bound bound;
    std::memcpy(&bound, record.data(), sizeof(bound));
    return bound;
  }

  Owner owner_;
};

// A world knows its planes by number: few and many, of floats and of doubles.
template <typename... More>
using With3d =
    ::testing::Types<SimplexView3, AaboView3, AabbView<3, double>, More...>;
using WorldCases =
    std::conditional_t<kTestsOnly3d, With3d<>, With3d<AabbView2, AaboView<4>>>;

template <typename... Views>
void AddWorlds(std::vector<OwnerRow>& rows, const ::testing::Types<Views...>&) {
  (rows.push_back({"World" + NameOf(Views()), "World",
                   detail::kLayoutOf<typename Views::Bound>,
                   std::is_same_v<ScalarOf<Views>, double>,
                   &OwnerOf<World<Views>>::Make, &OwnerOf<World<Views>>::Make}),
   ...);
}

// Quantized bounds of one and of two bytes.
template <typename View>
void AddQuantized(std::vector<QuantizedRow>& rows, const View&) {
  const auto add = [&](auto element) {
    using Element = decltype(element);
    rows.push_back(
        {NameOf(View()) + "Uint" + std::to_string(8 * sizeof(element)),
         detail::kLayoutOf<typename View::Bound>, sizeof(element),
         &OwnerOf<World<View>>::Make,
         &OwnerOf<QuantizedBounds<View, Element>>::Make,
         &OwnerOf<QuantizedWorld<View, Element>>::Make});
  };
  add(std::uint8_t{});
  add(std::uint16_t{});
}

template <int... kDims>
std::vector<QuantizedRow> QuantizedRowsOf() {
  std::vector<QuantizedRow> rows;
  (AddQuantized(rows, SimplexView<kDims>()), ...);
  (AddQuantized(rows, AabbView<kDims>()), ...);
  (AddQuantized(rows, AaboView<kDims>()), ...);
  return rows;
}

}  // namespace

std::vector<std::byte> OwnerRow::List(const Records& bounds) const {
  std::vector<std::byte> list;
  for (const Record& bound : bounds) {
    list.insert(list.end(), bound.begin(),
                bound.begin() + static_cast<std::ptrdiff_t>(record_bytes()));
  }
  return list;
}

std::vector<OwnerRow> OwnerRows() {
  std::vector<OwnerRow> rows;
  AddWorlds(rows, WorldCases());
  // What is the same code for all shapes: one of each, and both sizes.
  for (const QuantizedRow& row : AllQuantizedRows()) {
    if (row.name == "Simplex3Uint8" || row.name == "Aabb3Uint16" ||
        row.name.starts_with("Aabo3")) {
      rows.push_back({"Bounds" + row.name, "QuantizedBounds", row.layout, false,
                      row.make_bounds, row.make_floats});
      rows.push_back({"World" + row.name, "QuantizedWorld", row.layout, false,
                      row.make_world, row.make_floats});
    }
  }
  return rows;
}

std::vector<QuantizedRow> AllQuantizedRows() {
#if defined(HALFSPACE_TEST_ONLY_3D)
  return QuantizedRowsOf<3>();
#else
  return QuantizedRowsOf<2, 3, 4>();
#endif
}

}  // namespace halfspace::testing
