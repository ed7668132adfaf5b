// Histories of broad phases of any floats, against lists of their bodies, and
// saved bytes that were altered.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/error.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/history_input.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/broad_phase/history.h"

namespace halfspace::testing {
namespace {

class BroadPhaseInput : public HistoryInput {
 public:
  explicit BroadPhaseInput(Bytes& bytes)
      : HistoryInput(LayoutsOf(true), bytes) {}

  ::testing::AssertionResult Check() const {
    Bytes bytes(rest_.data(), rest_.size());
    ByteChoices choices(layout_, palettes_, bytes);
    BroadPhaseOptions options;
    options.moves_wait_for_update = how_ % 2 != 0;
    options.caller_locks = how_ / 2 % 2 != 0;
    if (how_ / 4 % 4 == 0) options.filter.keep = &KeepsSome;
    constexpr std::uint32_t kStrides[] = {1, 3, 700, 5000};
    BodyHistory history(layout_, choices, most_, kStrides[how_ / 16 % 4],
                        options,
                        how_ / 64 == 3 ? FpMode::kUpward : FpMode::kDefault);
    for (std::size_t steps = 2 + bytes.Below(6); steps-- > 0;) {
      for (std::size_t changes = 1 + bytes.Below(6); changes-- > 0;) {
        history.Change();
      }
      history.ExpectIsModel(bytes.Byte());
      ExpectAnswersOf(history.bodies(), history.model().Seen(), bytes);
      // The failed expectation has said why.
      if (::testing::Test::HasFailure()) return ::testing::AssertionFailure();
    }
    LoadAltered(history.bodies(), bytes);
    return ::testing::AssertionSuccess();
  }

 private:
  // Altered bytes are refused, or do no harm.
  void LoadAltered(const AnyBodies& bodies, Bytes& bytes) const {
    std::vector<std::byte> saved = bodies.Save();
    for (std::size_t n = bytes.Below(4); n-- > 0;) {
      const std::size_t at = bytes.Word() % saved.size();
      saved[at] = static_cast<std::byte>(bytes.Byte());
    }
    const auto loaded = MakeBodies(layout_);
    try {
      loaded->Load(saved);
    } catch (const Error&) {
      return;
    }
    const Planes everything = AllPlanes(layout_, kMost);
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
};

}  // namespace

void RunInput(Bytes& bytes) { Run<BroadPhaseInput>(bytes); }

}  // namespace halfspace::testing
