// The time of records (dispatch/broad_phase/records.h), which would have to
// wrap before a late body could be missed.
#include "dispatch/broad_phase/records.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace halfspace::testing {
namespace {

TEST(RecordsTest, TimePassesAtMostTwiceForEachBody) {
  constexpr std::uint32_t kBodies = 100;
  detail::Records records({}, 6);
  float planes[6] = {};
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 0; id < kBodies; ++id) ids.push_back(7 * id);
  records.Reserve(ids);
  for (const std::uint32_t id : ids) {
    ASSERT_TRUE(records.Insert(id, planes));
  }
  for (int interval = 0; interval < 3; ++interval) {
    std::uint32_t last = records.TimeOfQuery();
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      for (std::uint32_t n = 0; n <= i; n += 3) {  // most of them again
        planes[0] += 1;
        records.Move({&ids[i - n], 1}, planes);
      }
      const std::uint32_t time = records.TimeOfQuery();
      ASSERT_EQ(records.TimeOfQuery(), time);  // for any number of queries
      ASSERT_LE(time, 2 * (i + 1));
      for (std::uint32_t n = 0; n < kBodies; ++n) {
        ASSERT_EQ(records.IsLate(ids[n], time), n <= i);
        ASSERT_EQ(records.IsLate(ids[n], last), n < i);
      }
      last = time;
    }
    ASSERT_EQ(records.TakeMarks(), kBodies);
    for (const std::uint32_t id : ids) {
      ASSERT_FALSE(records.IsLate(id, last));
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
