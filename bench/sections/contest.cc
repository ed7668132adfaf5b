#include "bench/sections/contest.h"

#include "bench/base/text.h"

namespace halfspace::bench {

void Contest::Add(Row keys, Case c, Who who) {
  c.name = place_;
  for (const Cell& key : keys) {
    c.name += "/" + (key.value ? Fixed(*key.value, 1) : key.text);
  }
  c.group = place_;
  keys_.push_back(std::move(keys));
  cases_.push_back(std::move(c));
  whose_.push_back(who);
}

void Contest::Time(const Effort& effort) {
  timings_ = Measure(cases_, effort);
  fastest_ = size();
  for (std::size_t i = 0; i < size(); ++i) {
    if (whose_[i] != Who::kOurs &&
        (fastest_ == size() || timings_[i].Median() < fastest().Median())) {
      fastest_ = i;
    }
  }
}

std::vector<std::size_t> UpTo(std::size_t most,
                              std::vector<std::size_t> sizes) {
  std::erase_if(sizes, [most](std::size_t size) { return size > most; });
  if (sizes.empty()) sizes.push_back(most);
  return sizes;
}

}  // namespace halfspace::bench
