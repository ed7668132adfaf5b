// What becomes of the ids or pairs that a call finds.
#ifndef HALFSPACE_DISPATCH_SINK_H_
#define HALFSPACE_DISPATCH_SINK_H_

#include <algorithm>
#include <cstddef>

#include "halfspace/span.h"
#include "kernels/results.h"

namespace halfspace::dispatch {

// Writes items into a span, or calls a function with up to kRoom at a time. The
// first `skip` items are only counted, and so are those that the span has no
// room for. Base is what kernels see of it, a Results<Item>.
template <typename Base, typename Item, std::size_t kRoom>
struct Sink : Base {
  using Function = bool (*)(void* context, Span<const Item> items);

  Sink(Span<Item> to, std::size_t skipped) : Sink(skipped) {
    span = to;
    Place();
  }
  Sink(Function to, void* its_context, std::size_t skipped = 0)
      : Sink(skipped) {
    function = to;
    context = its_context;
    Use(buffer, kRoom);
  }

  // Returns whether to go on.
  bool Flush() {
    const auto count = static_cast<std::size_t>(this->next - this->begin);
    if (count == 0) return true;
    const std::size_t first =
        this->flushed >= skip ? 0 : std::min(count, skip - this->flushed);
    const std::size_t at = this->flushed + first - skip;  // in the span
    this->flushed += count;
    if (function != nullptr) {
      Use(buffer, kRoom);
      return first == count ||
             function(context, {buffer + first, count - first});
    }
    if (this->begin == buffer && first < count && at < span.size()) {
      std::copy_n(buffer + first, std::min(count - first, span.size() - at),
                  span.data() + at);
    }
    Place();
    return true;
  }

 private:
  explicit Sink(std::size_t skipped) : Base{}, skip(skipped) {
    this->flush = [](detail::Results<Item>& results) {
      return static_cast<Sink&>(results).Flush();
    };
  }

  // Items go to the caller's memory while that has room, and else to a buffer.
  void Place() {
    const std::size_t at = this->flushed - skip;
    if (this->flushed >= skip && at <= span.size() &&
        span.size() - at >= detail::kMostAtOnce) {
      Use(span.data() + at, span.size() - at);
    } else {
      Use(buffer, kRoom);
    }
  }
  void Use(Item* memory, std::size_t room) {
    this->begin = this->next = memory;
    this->full = memory + (room - detail::kMostAtOnce + 1);
  }

  Span<Item> span;
  Function function = nullptr;
  void* context = nullptr;
  std::size_t skip;
  Item buffer[kRoom];
};

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SINK_H_
