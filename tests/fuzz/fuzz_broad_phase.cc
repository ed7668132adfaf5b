// Histories of broad phases against lists of their bodies, and saved bytes that
// were altered.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/fuzz.h"
#include "tests/library/broad_phase/history.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/altered.h"

namespace halfspace::testing {

void Fuzz(Random& random) {
  const Layout layout = OneOf(LayoutsOf(true), random);
  Choices choices(layout, random);
  BroadPhaseOptions options;
  options.moves_are_seen_at_once = random() % 2 != 0;
  options.caller_locks = random() % 2 != 0;
  if (random() % 4 == 0) options.filter.keep = &KeepsSome;
  constexpr std::uint32_t kStrides[] = {1, 3, 700, 5000};
  const std::size_t most = 1 + random() % (random() % 8 == 0 ? 900 : 80);
  BodyHistory history(layout, choices, most, OneOf(kStrides, random), options,
                      random() % 4 == 0 ? FpMode::kUpward : FpMode::kDefault);
  for (std::size_t steps = 2 + random() % 6; steps-- > 0;) {
    for (std::size_t changes = 1 + random() % 6; changes-- > 0;) {
      history.Change();
    }
    history.ExpectIsModel(random() % 256);
    if (::testing::Test::HasFailure()) return;
  }
  const AlignedCopy saved(BytesOf(history.bodies()));
  const auto bytes = saved.bytes();
  // After a header, which has its size, is a blob.
  std::uint64_t tree_bytes = 0;
  std::memcpy(&tree_bytes, &bytes[24], sizeof(tree_bytes));
  for (std::size_t n = random() % 8; n-- > 0;) {
    if (random() % 2 == 0) {
      AlterPart(layout, bytes.subspan(64, tree_bytes), random);
    } else {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }
  }
  LoadAltered(layout, bytes, random);
}

}  // namespace halfspace::testing
