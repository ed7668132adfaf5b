// Copies of a broad phase, and its bytes.
#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/errors/error.h"

namespace halfspace::detail {
namespace {

constexpr const char* kLoad = "BroadPhase::Load";
constexpr char kMagic[8] = {'h', 'a', 'l', 'f', 'b', 'o', 'd', 'y'};
constexpr std::uint32_t kVersion = 2;

// After the header come the blob of the tree, the pairs, the collides_with
// masks, and the ids of bodies that changed since the last UpdatePairs() and
// since the last Update(). Each begins at a multiple of 64 bytes.
struct alignas(64) SaveHeader {
  std::uint64_t bytes;  // of all
  char magic[8];
  std::uint32_t version;  // other bytes first: another byte order
  std::uint32_t planes;
  std::uint64_t tree_bytes;
  std::uint64_t pairs;
  std::uint64_t collides_with;
  std::uint64_t changed;
  std::uint64_t changed_for_order;
  Wear wear;
  std::uint32_t unused[12];
};
static_assert(sizeof(SaveHeader) == 128 && sizeof(Wear) == 16 &&
              offsetof(SaveHeader, unused) + sizeof(SaveHeader::unused) ==
                  sizeof(SaveHeader));

constexpr std::size_t kAlignment = 64;
constexpr std::size_t Padded(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

[[noreturn]] void ThrowNotSaved(const char* expected,
                                const std::string& given) {
  dispatch::ThrowInvalid(kLoad, "bytes", expected, given);
}

// The parts of saved bytes, one after another.
class SavedParts {
 public:
  explicit SavedParts(Span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  Span<const T> Next(std::uint64_t count) {
    const std::size_t left = bytes_.size() - next_;
    if (count > left / sizeof(T) ||
        Padded(static_cast<std::size_t>(count) * sizeof(T)) > left) {
      ThrowNotSaved("all bytes of BroadPhase::Save()",
                    std::to_string(bytes_.size()) + " bytes");
    }
    const Span<const T> part(reinterpret_cast<const T*>(bytes_.data() + next_),
                             static_cast<std::size_t>(count));
    next_ += Padded(static_cast<std::size_t>(count) * sizeof(T));
    return part;
  }

 private:
  Span<const std::byte> bytes_;
  std::size_t next_ = 0;
};

template <typename T>
Span<const std::byte> BytesOf(const T* items, std::size_t count) {
  return {reinterpret_cast<const std::byte*>(items), count * sizeof(T)};
}

bool AreEqual(const BroadPhaseOptions& a, const BroadPhaseOptions& b) {
  return a.filter.keep == b.filter.keep &&
         a.filter.context == b.filter.context && a.memory == b.memory &&
         a.moves_are_seen_at_once == b.moves_are_seen_at_once &&
         a.caller_locks == b.caller_locks;
}

void Copy(BroadPhaseState& from, BroadPhaseState& to) {
  Changing changing(from, Changing::kAllMarked);
  from.Flush();
  changing.ShowTree();
  to.Assign(from);
}

}  // namespace

BroadPhaseCore::BroadPhaseCore(const BroadPhaseCore& other)
    : BroadPhaseCore(other.state_->type, other.state_->options) {
  Copy(*other.state_, *state_);
}

BroadPhaseCore& BroadPhaseCore::operator=(const BroadPhaseCore& other) {
  if (this == &other) return *this;
  if (state_ == nullptr || !AreEqual(state_->options, other.state_->options)) {
    return *this = BroadPhaseCore(other);
  }
  Copy(*other.state_, *state_);
  return *this;
}

void BroadPhaseCore::Save(SaveFunction function, void* context) const {
  BroadPhaseState& state = *state_;
  Changing changing(state, Changing::kAllMarked);
  state.Flush();
  changing.ShowTree();
  const auto changed = state.IdsOf(Records::kForPairs, state.options.memory);
  const auto changed_for_order =
      state.IdsOf(Records::kForOrder, state.options.memory);
  const Span<const std::byte> tree = state.tree.Blob();
  const Span<const IdPair> pairs = state.events.pairs();
  const Span<const std::byte> parts[] = {
      tree, BytesOf(pairs.data(), pairs.size()),
      BytesOf(state.collides_with.data(), state.collides_with.size()),
      BytesOf(changed.data(), changed.size()),
      BytesOf(changed_for_order.data(), changed_for_order.size())};
  SaveHeader header{};
  header.bytes = sizeof(header);
  for (const Span<const std::byte>& part : parts) {
    header.bytes += Padded(part.size());
  }
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.version = kVersion;
  header.planes = static_cast<std::uint32_t>(state.planes());
  header.tree_bytes = tree.size();
  header.pairs = pairs.size();
  header.collides_with = state.collides_with.size();
  header.changed = changed.size();
  header.changed_for_order = changed_for_order.size();
  header.wear = state.wear;
  function(context, BytesOf(&header, 1));
  for (const Span<const std::byte>& part : parts) {
    constexpr std::byte kPadding[kAlignment] = {};
    if (part.empty()) continue;
    function(context, part);
    const std::size_t padding = Padded(part.size()) - part.size();
    if (padding != 0) function(context, {kPadding, padding});
  }
}

// Reads into new memory and then swaps, so a call that fails changes nothing.
void BroadPhaseCore::Load(Span<const std::byte> bytes) {
  BroadPhaseState& state = *state_;
  SaveHeader header;
  if (bytes.size() < sizeof(header)) {
    ThrowNotSaved("all bytes of BroadPhase::Save()",
                  std::to_string(bytes.size()) + " bytes");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 ||
      header.version != kVersion || header.planes != state.planes()) {
    ThrowNotSaved(
        "bytes of BroadPhase::Save() of this type, byte order and format 2",
        header.version >> 24 != 0 ? "bytes in the other byte order" : "others");
  }
  // The bytes may be misaligned.
  BroadPhaseCore loaded(state.type, state.options);
  BroadPhaseState& to = *loaded.state_;
  const Scratch aligned(state.options.memory, Padded(bytes.size()));
  std::memcpy(aligned.data(), bytes.data(), bytes.size());
  SavedParts parts({aligned.data(), bytes.size()});
  parts.Next<SaveHeader>(1);
  const auto blob = parts.Next<std::byte>(header.tree_bytes);
  const auto pairs = parts.Next<IdPair>(header.pairs);
  const auto collides_with = parts.Next<std::uint32_t>(header.collides_with);
  const auto changed = parts.Next<std::uint32_t>(header.changed);
  const auto changed_for_order =
      parts.Next<std::uint32_t>(header.changed_for_order);
  std::size_t id_limit = 0;
  for (const Span<const std::uint32_t> ids : {changed, changed_for_order}) {
    for (const std::uint32_t id : ids) {
      if (id >= kMostObjects) {
        ThrowNotSaved("ids below 2^31", std::to_string(id));
      }
      id_limit = std::max<std::size_t>(id_limit, id + 1);
    }
  }
  BvhTree tree(state.type, state.options.memory);
  if (!blob.empty()) tree.Load(blob, false);
  to.records.ReserveList(std::max(id_limit, tree.id_limit()));
  to.Adopt(std::move(tree));
  to.events.Load(pairs);
  to.wear = header.wear;
  to.collides_with.assign(collides_with.begin(), collides_with.end());
  if (!collides_with.empty() && collides_with.size() < to.tree.id_limit()) {
    ThrowNotSaved("a mask for each id",
                  std::to_string(collides_with.size()) + " masks");
  }
  const auto add = [&](Records::ChangedSet set, Span<const std::uint32_t> ids) {
    to.records.Reserve(ids);
    for (const std::uint32_t id : ids) to.records.Add(set, id);
  };
  add(Records::kForPairs, changed);
  add(Records::kForOrder, changed_for_order);
  const Changing changing(state);
  state.Swap(to);
}

}  // namespace halfspace::detail
