// Histories of BVHs: changes of every kind, of a BVH, its copies and a list of
// its objects.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_HISTORY_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_HISTORY_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/answers.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {

// Bounds of every kind: small ones that move, and each that is special.
// Searches may trap on subnormals or flush them, so `may_trap` leaves these
// out.
class Choices {
 public:
  Choices(const Layout& layout, Random& random, bool may_trap = false);
  std::size_t Below(std::size_t end) { return random_() % end; }
  Planes Next();
  // By up to a quarter of a small bound's size, or somewhere else.
  Planes Moved(const Planes& bound);
  BodyMasks Masks();

 private:
  Layout layout_;
  bool may_trap_;
  Random& random_;
  Spheres small_;
  Spheres large_;
  Planes coincident_;
  Planes last_;
};

// Each part once, in reverse on each of three threads.
void RunOnThreads(std::size_t count, const Runner::Part& part);

// Doubles that are rounded outward to these floats.
BoundList InDoubles(const Layout& layout, std::vector<Planes> floats);

class BvhHistory {
 public:
  // Lists have up to `most` objects. With `memory`, each change is tried with
  // less memory than it needs, which changes nothing.
  BvhHistory(const Layout& layout, Choices& choices, std::size_t size,
             std::size_t most, FpMode mode, CountingMemory* memory = nullptr);

  const AnyBvh& bvh() const { return *all_[0]; }
  const Objects& objects() const { return objects_; }

  // One change. Returns its number, for messages.
  std::size_t Change();
  // Each BVH has the objects and their order, and the first answers as a list
  // of them.
  void ExpectIsModel(const HowToAsk& how, Random& random) const;
  // The ids of objects that came, went or moved since the last call.
  Ids TakeChanged();

 private:
  template <typename Call>
  void Each(const Call& call) {
    for (auto& bvh : all_) {
      if (memory_ == nullptr) {
        RunIn(mode_, [&] { call(*bvh); });
        continue;
      }
      const auto blob = bvh->Blob();
      const std::vector<std::byte> before(blob.begin(), blob.end());
      FailuresOf(
          *memory_, [&] { call(*bvh); },
          [&] {
            // What was taken from it stays valid.
            EXPECT_EQ(bvh->Blob().data(), blob.data());
            EXPECT_TRUE(std::ranges::equal(bvh->Blob(), before));
          });
    }
  }
  // The copies run on threads, and must be the same.
  Runner RunnerOf(const AnyBvh& bvh) const;
  BoundList Bounds(std::size_t count);
  std::uint32_t AnyId();
  Ids AnyIds(std::size_t count);
  void Insert(std::size_t count, bool is_list);
  void InsertAs(std::size_t count);
  void Erase(std::size_t count, bool is_list);
  void Set(std::size_t count, std::size_t how);
  void RefitAll();
  void SetMasks(std::size_t count);
  void ReserveOrClear(std::size_t count);
  void CopyOrLoad();
  void RefuseLists(std::size_t count);
  void Has(std::uint32_t id, const Planes& bound);

  // A BVH of a blob in place, whose bytes no change may write.
  struct Blob {
    std::unique_ptr<AlignedCopy> bytes;
    std::vector<std::byte> untouched;
  };

  Layout layout_;
  Choices& choices_;
  std::size_t most_;
  FpMode mode_;
  CountingMemory* memory_;
  std::vector<Blob> blobs_;
  std::vector<std::unique_ptr<AnyBvh>> all_;  // the first, and a copy of it
  Objects objects_;
  Ids changed_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_HISTORY_H_
