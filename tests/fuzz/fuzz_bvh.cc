// Histories of BVHs against lists of their objects; and altered blobs, of which
// calls may read nothing else.
#include <cstddef>

#include "tests/fuzz/fuzz.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/altered.h"
#include "tests/library/bvh/history.h"

namespace halfspace::testing {
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
  const auto bvh = history.bvh().Copy();
  if (random() % 4 == 0) bvh->Reserve(4097);  // so that its leaves have codes
  const AlignedCopy altered(bvh->Blob());
  const auto bytes = altered.bytes();
  for (std::size_t i = random() % 20; i-- > 0 && !bytes.empty();) {
    const std::size_t how = random() % 4;
    if (how < 2) {
      AlterPart(layout, bytes, random);
    } else {
      const std::size_t end = how == 2 ? 64 : bytes.size();
      bytes[random() % end] = static_cast<std::byte>(random());
    }
  }
  (void)UseAltered(layout, bytes, {}, random);
}

}  // namespace halfspace::testing
