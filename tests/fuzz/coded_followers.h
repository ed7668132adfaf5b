// Codes that follow floats, a world that owns both, and a plain list of what
// they should hold.
#ifndef HALFSPACE_TESTS_FUZZ_CODED_FOLLOWERS_H_
#define HALFSPACE_TESTS_FUZZ_CODED_FOLLOWERS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "halfspace/codes.h"
#include "halfspace/world.h"

namespace halfspace::testing {

template <typename Case>
class CodedFollowers {
 public:
  using FloatView = typename Case::View;
  using Bound = typename FloatView::Bound;
  using TheCodes = Codes<FloatView, typename Case::Code>;
  using Coded = CodedWorld<FloatView, typename Case::Code>;

  explicit CodedFollowers(std::span<const Bound> bounds)
      : model_(bounds.begin(), bounds.end()),
        codes_(World<FloatView>(bounds).view()),
        coded_(bounds) {}

  const std::vector<Bound>& model() const { return model_; }
  const TheCodes& codes() const { return codes_; }
  const Coded& coded() const { return coded_; }

  void Push(const Bound& bound) {
    codes_.Push(bound);
    coded_.Push(bound);
    model_.push_back(bound);
  }
  void Set(std::size_t index, const Bound& bound) {
    codes_.Set(index, bound);
    coded_.Set(index, bound);
    model_[index] = bound;
  }
  void EraseBySwap(std::size_t index) {
    codes_.EraseBySwap(index);
    coded_.EraseBySwap(index);
    model_[index] = model_.back();
    model_.pop_back();
  }
  void Recode() {
    codes_.Recode(World<FloatView>(model_).view());
    coded_.Recode();
  }
  void Reserve(std::size_t objects) {
    codes_.Reserve(objects);
    coded_.Reserve(objects);
  }
  void Clear() {
    codes_.Clear();
    coded_.Clear();
    model_.clear();
  }

 private:
  std::vector<Bound> model_;
  TheCodes codes_;
  Coded coded_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_CODED_FOLLOWERS_H_
