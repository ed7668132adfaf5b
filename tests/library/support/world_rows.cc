// The rows of flat_cases.h and quantized_rows.h, for every kind of world.
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "halfspace/quantized.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/quantized_rows.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class AnyQuantizedOf : public AnyQuantized {
 public:
  using View = typename Case::View;
  using Bound = typename View::Bound;

  explicit AnyQuantizedOf(const std::vector<float>& values)
      : floats_(Bounds(values)), quantized_(floats_.view()) {}

  AnyWorld floats() const override { return AnyWorld(floats_); }
  AnyWorld quantized() const override { return AnyWorld(quantized_); }
  AnyWorld refined() const override {
    return AnyWorld(Refined(quantized_, floats_.view()));
  }
  AnyWorld world() override {
    if (!world_) world_.emplace(floats_);
    return AnyWorld(*world_);
  }
  bool Fits() const override { return quantized_.Fits(); }
  void Set(std::size_t i, const float* values) override {
    quantized_.Set(i, BoundOf(values));
  }
  void Push(const float* values) override { quantized_.Push(BoundOf(values)); }

 private:
  static Bound BoundOf(const float* values) {
    Bound bound;
    std::memcpy(&bound, values, sizeof(bound));
    return bound;
  }
  static std::vector<Bound> Bounds(const std::vector<float>& values) {
    std::vector<Bound> bounds;
    for (std::size_t i = 0; i < values.size(); i += kPlanes<View>) {
      bounds.push_back(BoundOf(&values[i]));
    }
    return bounds;
  }

  World<View> floats_;
  QuantizedBounds<View, typename Case::Element> quantized_;
  std::optional<QuantizedWorld<View, typename Case::Element>> world_;
};

template <typename... Cases>
std::vector<QuantizedRow> QuantizedRowsOf(const ::testing::Types<Cases...>&) {
  return {
      {QuantizedCaseNames::GetName<Cases>(0),
       detail::kLayoutOf<typename Cases::View::Bound>,
       sizeof(typename Cases::Element),
       [](const std::vector<float>& values) -> std::unique_ptr<AnyQuantized> {
         return std::make_unique<AnyQuantizedOf<Cases>>(values);
       }}...};
}

template <typename Case>
FlatCase RowOf() {
  using Stored = typename Case::Stored;
  using Scalar = ScalarOf<Stored>;
  return {NameOf(Case()),
          detail::kLayoutOf<typename Stored::Bound>,
          detail::kLayoutOf<typename Case::View::Bound>,
          std::is_same_v<Scalar, double>,
          [](const PlanePointers& planes, std::size_t size) {
            Stored stored;
            for (std::size_t p = 0; p < kPlanes<Stored>; ++p) {
              PlaneOf(stored, p) = static_cast<const Scalar*>(planes[p]);
            }
            stored.size = size;
            return AnyWorld(Case::Seen(stored));
          },
          [](const void* stored, void* seen) {
            const auto query =
                Case::Seen(*static_cast<const typename Stored::Query*>(stored));
            std::memcpy(seen, &query, sizeof(query));
          }};
}

template <typename... Cases>
std::vector<FlatCase> RowsOf(const ::testing::Types<Cases...>&) {
  return {RowOf<Cases>()...};
}

}  // namespace

std::vector<QuantizedRow> AllQuantizedRows() {
  return QuantizedRowsOf(QuantizedCases());
}

std::vector<FlatCase> AllFlatRows() { return RowsOf(AllCases()); }

}  // namespace halfspace::testing
