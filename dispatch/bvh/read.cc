// What a BVH says of its objects without a query.
#include <algorithm>
#include <limits>
#include <string>

#include "dispatch/bvh/layout.h"
#include "dispatch/errors/error.h"

namespace halfspace::detail {

bool BvhTree::Has(std::uint32_t id) const {
  if (block_ == nullptr || id >= header().ids) return false;
  if (levels_.slots == nullptr) return true;
  const std::uint32_t slot = levels_.slots[id];
  return slot < header().slots && levels_.ids[slot] == id;
}

void BvhTree::CheckId(std::uint32_t id, const char* call) const {
  if (Has(id)) return;
  dispatch::ThrowInvalid(call, "id", "the id of an object", std::to_string(id));
}

void BvhTree::Get(std::uint32_t id, Span<float> values) const {
  constexpr const char* kCall = "Bvh::Get";
  CheckId(id, kCall);
  const std::uint32_t* const ids = levels_.ids;
  const std::size_t slot =
      levels_.slots != nullptr
          ? levels_.slots[id]
          : static_cast<std::size_t>(std::find(ids, ids + slots(), id) - ids);
  if (slot == slots()) {  // in an altered blob
    dispatch::ThrowInvalid(kCall, "id", "an element of ids()",
                           std::to_string(id));
  }
  for (std::size_t p = 0; p < values.size(); ++p) {
    values[p] = levels_.level[0].Value(p, slot);
  }
}

void BvhTree::Bounds(Span<float> values) const {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const BvhLevel* const top =
      block_ == nullptr ? nullptr : &levels_.level[levels_.count - 1];
  for (std::size_t p = 0; p < values.size(); ++p) {
    const float sign = p < shape_.axes ? 1.0f : -1.0f;
    float least = kInf;
    for (std::size_t i = 0; top != nullptr && i < top->size; ++i) {
      const float v = sign * top->Value(p, i);
      least = v == v ? std::min(least, v) : -kInf;
    }
    values[p] = sign * least;
  }
}

}  // namespace halfspace::detail
