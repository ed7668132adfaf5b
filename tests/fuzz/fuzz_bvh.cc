// Histories of BVHs of any floats, against lists of their objects; and altered
// blobs, of which calls may read nothing else.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/history_input.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/altered.h"

namespace halfspace::testing {
namespace {

class BvhInput : public HistoryInput {
 public:
  explicit BvhInput(Bytes& bytes) : HistoryInput(LayoutsOf(false), bytes) {}

  ::testing::AssertionResult Check() const {
    Bytes bytes(rest_.data(), rest_.size());
    ByteChoices choices(layout_, palettes_, bytes);
    BvhHistory history(layout_, choices, bytes.Below(most_), most_,
                       kFpModes[how_ % 6]);
    for (std::size_t steps = 2 + bytes.Below(4); steps-- > 0;) {
      for (std::size_t changes = 1 + bytes.Below(20); changes-- > 0;) {
        history.Change();
      }
      Random random(bytes.Byte());
      history.ExpectIsModel({.shapes = 1}, random);
      ExpectAnswersOf(history.bvh(), history.objects(), bytes);
      // The failed expectation has said why.
      if (::testing::Test::HasFailure()) return ::testing::AssertionFailure();
    }
    LoadAltered(history.bvh(), choices, bytes);
    return ::testing::AssertionSuccess();
  }

 private:
  void LoadAltered(const AnyBvh& bvh, ByteChoices& choices,
                   Bytes& bytes) const {
    const AlignedCopy blob(bvh.tree().Blob());
    const auto altered = blob.bytes();
    for (std::size_t i = bytes.Below(20); i-- > 0 && !altered.empty();) {
      const std::size_t at =
          bytes.Below(2) == 0 ? bytes.Below(64) : bytes.Word();
      altered[at % altered.size()] = static_cast<std::byte>(bytes.Byte());
    }
    Random random(bytes.Byte());
    try {
      const auto loaded = bvh.Copy()->Loaded(altered, bytes.Below(2) == 0, {});
      AskAltered(*loaded, random);
      for (std::size_t i = bytes.Below(200); i-- > 0;) {
        try {
          ChangeAltered(*loaded, bytes.Below(kAlteredChanges), choices.Next(),
                        random);
        } catch (const std::invalid_argument&) {
          // Refused.
        }
        if (bytes.Below(8) == 0) AskAltered(*loaded, random);
      }
    } catch (const std::invalid_argument&) {
      // Refused.
    }
  }
};

}  // namespace

void RunInput(Bytes& bytes) { Run<BvhInput>(bytes); }

}  // namespace halfspace::testing
