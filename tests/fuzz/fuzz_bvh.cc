// Histories of BVHs against lists of their objects; and altered blobs, of which
// calls may read nothing else.
#include <cstddef>
#include <stdexcept>

#include "tests/fuzz/fuzz.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/altered.h"
#include "tests/library/bvh/history.h"

namespace halfspace::testing {
namespace {

void LoadAltered(const AnyBvh& bvh, Choices& choices, Random& random) {
  const AlignedCopy blob(bvh.tree().Blob());
  const auto altered = blob.bytes();
  for (std::size_t i = random() % 20; i-- > 0 && !altered.empty();) {
    const std::size_t most = random() % 2 == 0 ? 64 : altered.size();
    altered[random() % most] = static_cast<std::byte>(random());
  }
  try {
    const auto loaded = bvh.Copy()->Loaded(altered, random() % 2 == 0, {});
    AskAltered(*loaded, random);
    for (std::size_t i = random() % 200; i-- > 0;) {
      try {
        ChangeAltered(*loaded, random() % kAlteredChanges, choices.Next(),
                      random);
      } catch (const std::invalid_argument&) {
        // Refused.
      }
      if (random() % 8 == 0) AskAltered(*loaded, random);
    }
  } catch (const std::invalid_argument&) {
    // Refused.
  }
}

}  // namespace

void Fuzz(Random& random) {
  const Layout layout = OneOf(LayoutsOf(false), random);
  const std::size_t most = 1 + random() % (random() % 8 == 0 ? 900 : 80);
  Choices choices(layout, random);
  BvhHistory history(layout, choices, random() % most, most,
                     OneOf(kFpModes, random));
  for (std::size_t steps = 2 + random() % 4; steps-- > 0;) {
    for (std::size_t changes = 1 + random() % 20; changes-- > 0;) {
      history.Change();
    }
    history.ExpectIsModel({.mask = random() % 2 == 0 ? 0xFFFFFFFF : 1,
                           .is_special = random() % 2 == 0,
                           .shapes = 1},
                          random);
    if (::testing::Test::HasFailure()) return;
  }
  LoadAltered(history.bvh(), choices, random);
}

}  // namespace halfspace::testing
