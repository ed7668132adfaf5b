// Quantized bounds that follow floats, a world that owns both, and a plain list
// of what they should hold.
#ifndef HALFSPACE_TESTS_FUZZ_QUANTIZED_FOLLOWERS_H_
#define HALFSPACE_TESTS_FUZZ_QUANTIZED_FOLLOWERS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/world.h"

namespace halfspace::testing {

template <typename Case>
class QuantizedFollowers {
 public:
  using FloatView = typename Case::View;
  using Bound = typename FloatView::Bound;
  using TheBounds = QuantizedBounds<FloatView, typename Case::Element>;
  using TheWorld = QuantizedWorld<FloatView, typename Case::Element>;

  explicit QuantizedFollowers(std::span<const Bound> bounds)
      : model_(bounds.begin(), bounds.end()),
        quantized_(World<FloatView>(bounds).view()),
        quantized_world_(bounds) {}

  const std::vector<Bound>& model() const { return model_; }
  const TheBounds& quantized() const { return quantized_; }
  const TheWorld& quantized_world() const { return quantized_world_; }

  void Push(const Bound& bound) {
    quantized_.Push(bound);
    quantized_world_.Push(bound);
    model_.push_back(bound);
  }
  void Set(std::size_t index, const Bound& bound) {
    quantized_.Set(index, bound);
    quantized_world_.Set(index, bound);
    model_[index] = bound;
  }
  void EraseBySwap(std::size_t index) {
    quantized_.EraseBySwap(index);
    quantized_world_.EraseBySwap(index);
    model_[index] = model_.back();
    model_.pop_back();
  }
  void Requantize() {
    quantized_.Requantize(World<FloatView>(model_).view());
    quantized_world_.Requantize();
  }
  void Reserve(std::size_t objects) {
    quantized_.Reserve(objects);
    quantized_world_.Reserve(objects);
  }
  void Clear() {
    quantized_.Clear();
    quantized_world_.Clear();
    model_.clear();
  }

 private:
  std::vector<Bound> model_;
  TheBounds quantized_;
  TheWorld quantized_world_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_QUANTIZED_FOLLOWERS_H_
