// Histories of broad phases against lists of their bodies, and saved bytes that
// were altered.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/error.h"
#include "tests/fuzz/fuzz.h"
#include "tests/library/broad_phase/history.h"

namespace halfspace::testing {
namespace {

// Altered bytes are refused, or do no harm.
void LoadAltered(const AnyBodies& bodies, Random& random) {
  std::vector<std::byte> saved = bodies.Save();
  for (std::size_t n = random() % 4; n-- > 0;) {
    saved[random() % saved.size()] = static_cast<std::byte>(random());
  }
  const auto loaded = MakeBodies(bodies.layout);
  try {
    loaded->Load(saved);
  } catch (const Error&) {
    return;
  }
  const Planes everything = AllPlanes(bodies.layout, kMost);
  const Shape all{Shape::kBound, {everything.begin(), everything.end()}};
  Ids ids(loaded->size());
  ids.resize(std::min(loaded->Find(all, ids, {}, 0), ids.size()));
  (void)loaded->Validate();
  loaded->UpdatePairs({});
  loaded->Rebuild({});
  if (std::all_of(ids.begin(), ids.end(),
                  [&](std::uint32_t id) { return loaded->Has(id); })) {
    loaded->Erase(ids);
  }
}

}  // namespace

void Fuzz(Random& random) {
  const Layout layout = OneOf(LayoutsOf(true), random);
  Choices choices(layout, random);
  BroadPhaseOptions options;
  options.moves_wait_for_update = random() % 2 != 0;
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
  LoadAltered(history.bodies(), random);
}

}  // namespace halfspace::testing
