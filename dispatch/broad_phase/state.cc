#include "dispatch/broad_phase/state.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <tuple>

#include "dispatch/broad_phase/exact.h"
#include "dispatch/bvh/layout.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kMostIds = std::size_t{1} << 29;

// How much larger a bound is on the side to which a body moves, in margins.
constexpr float kMostAhead = 3;
constexpr float kShareAhead = 0.75f;

// All that looks at planes is in the default floating-point mode. A plane of a
// tree is never a NaN: it is infinite if the body has a NaN there.
bool IsBeyond(float plane, float other, bool is_max) {
  return is_max ? plane > other : plane < other;
}
float NumberOf(float plane, bool is_max) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  return plane == plane ? plane : is_max ? kInf : -kInf;
}

float LoadPlane(float& of_tree) {
  return std::atomic_ref<float>(of_tree).load(std::memory_order_relaxed);
}

void MoveOutward(float& of_tree, float plane, bool is_max) {
  const std::atomic_ref<float> shared(of_tree);
  float old = shared.load(std::memory_order_relaxed);
  while (IsBeyond(plane, old, is_max)) {
    // Behind the store that takes the mark of the body's own bound.
    if (shared.compare_exchange_weak(old, plane, std::memory_order_release,
                                     std::memory_order_relaxed)) {
      return;
    }
  }
}

// Returns whether all planes of a body are inside the planes of a node, or on
// level 0, of the body's larger bound. A NaN is inside nothing. The first plane
// of the node is at `of_tree`, and the others are in the next planes of its
// block.
template <std::size_t kAxes>
bool PlanesEnclose(float* of_tree, const float* planes) {
  bool do_enclose = true;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const std::size_t max = kAxes + k;
    do_enclose &= LoadPlane(of_tree[k * kBlockObjects]) <= planes[k];
    do_enclose &= planes[max] <= LoadPlane(of_tree[max * kBlockObjects]);
  }
  return do_enclose;
}

// A bit for each plane that is beyond that of a node, or of a body on level 0.
template <std::size_t kAxes>
unsigned BeyondOf(float* of_tree, const float* planes) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const std::size_t max = kAxes + k;
    const float of_min = LoadPlane(of_tree[k * kBlockObjects]);
    const float of_max = LoadPlane(of_tree[max * kBlockObjects]);
    bits |= unsigned{IsBeyond(planes[k], of_min, false)} << k;
    bits |= unsigned{IsBeyond(planes[max], of_max, true)} << max;
  }
  return bits;
}

// Where the first plane of a body is in the tree, or null.
float* FindPlanes(const BvhLevels& levels, std::size_t id_limit,
                  std::uint32_t id) {
  if (id >= id_limit) return nullptr;
  const std::size_t slot = levels.slots[id];
  if (slot >= levels.level[0].size || levels.ids[slot] != id) return nullptr;
  return &levels.level[0].Value(0, slot);
}

}  // namespace

ListMemory::~ListMemory() {
  if (data_ != few_) FreeBlock(memory_, data_, bytes_);
}

void ListMemory::Grow(std::size_t bytes, std::size_t used) {
  bytes = std::max(bytes, bytes_ + bytes_ / 2);
  void* const data = AllocateBlock(memory_, bytes);
  if (used > 0) std::memcpy(data, data_, used);
  if (data_ != few_) FreeBlock(memory_, data_, bytes_);
  data_ = data;
  bytes_ = bytes;
}

void ListMemory::Swap(ListMemory& other) {
  if (data_ == few_ || other.data_ == other.few_) std::swap(few_, other.few_);
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  if (data_ == other.few_) data_ = few_;
  if (other.data_ == few_) other.data_ = other.few_;
}

Bodies::Bodies(const MemoryResource& memory, std::size_t ids,
               std::size_t planes)
    : ids_(ids),
      planes_(planes),
      words_of_marks_((ids + 63) / 64 * 8),
      memory_(memory, bytes()),
      marks_(reinterpret_cast<std::uint64_t*>(memory_.data())),
      touched_(marks_ + words_of_marks_),
      words_(reinterpret_cast<std::atomic<std::uint32_t>*>(touched_ +
                                                           words_of_marks_)),
      masks_(words_ + ids * (1 + planes)) {
  std::fill_n(marks_, 2 * words_of_marks_, 0);
  std::uninitialized_default_construct_n(words_,
                                         ids * (1 + planes + kMaskWords));
}

std::size_t Bodies::bytes() const {
  return 2 * words_of_marks_ * sizeof(marks_[0]) +
         ids_ * (1 + planes_ + kMaskWords) * sizeof(words_[0]);
}

namespace {

// The bytes of eight marks that have a bit, a bit for each of them.
std::uint64_t BitsOf(std::uint64_t bytes, std::uint8_t mark) {
  if constexpr (std::endian::native == std::endian::big) {
    bytes = __builtin_bswap64(bytes);
  }
  const std::uint64_t ones =
      bytes >> std::countr_zero(mark) & 0x0101010101010101;
  return ones * 0x0102040810204080 >> 56;
}

}  // namespace

std::uint64_t Bodies::MovedOf(std::size_t word) const {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::atomic_ref<std::uint64_t> eight(marks_[8 * word + i]);
    bits |= BitsOf(eight.load(std::memory_order_acquire), kMoved) << 8 * i;
  }
  return bits;
}

std::uint64_t Bodies::TakeMoved(std::size_t word) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::atomic_ref<std::uint64_t> eight(marks_[8 * word + i]);
    constexpr std::uint64_t kAll = EightOf(kMoved);
    if ((eight.load(std::memory_order_relaxed) & kAll) == 0) continue;
    bits |= BitsOf(eight.fetch_and(~kAll), kMoved) << 8 * i;
  }
  return bits;
}

std::uint64_t Bodies::TakePairMarks(std::size_t word) {
  const auto take = [word](std::uint64_t* of, Mark mark) -> std::uint64_t {
    const std::atomic_ref<std::uint64_t> eight(of[word]);
    const std::uint64_t all = EightOf(mark);
    if ((eight.load(std::memory_order_relaxed) & all) == 0) return 0;
    return eight.fetch_and(~all) & all;
  };
  return take(marks_, kNewPairs) | take(touched_, kTouched);
}

bool Bodies::DoOverlapSlowly(std::uint32_t a, std::uint32_t b) const {
  Body of_a;
  Body of_b;
  if (!Read(a, of_a, false) || !Read(b, of_b, false)) return false;
  return detail::DoOverlap(of_a.planes, of_b.planes, planes_ / 2);
}

void Bodies::ReadMasks(std::size_t id, BodyMasks& masks) const {
  const std::atomic<std::uint32_t>* const words = MasksAt(id);
  const auto load = [&](std::size_t w) {
    return words[w].load(std::memory_order_acquire) |
           std::uint64_t{words[w + 1].load(std::memory_order_acquire)} << 32;
  };
  masks.category = load(0);
  masks.collides_with = load(2);
}

void Bodies::Wait(std::size_t tries) {
  if (tries % 64 == 0) std::this_thread::yield();
}

// The stores of the values release, so that they stay behind the first store of
// the first word.
void Bodies::Write(std::size_t id, const float* planes, const BodyMasks* masks,
                   bool is_present) {
  std::atomic<std::uint32_t>* const words = At(id);
  const std::uint32_t before = words[0].load(std::memory_order_relaxed);
  words[0].store(before | kIsWritten, std::memory_order_relaxed);
  const auto store = [](std::atomic<std::uint32_t>& word, std::uint64_t value) {
    word.store(static_cast<std::uint32_t>(value), std::memory_order_release);
  };
  for (std::size_t p = 0; p < planes_ && planes != nullptr; ++p) {
    store(words[1 + p], std::bit_cast<std::uint32_t>(planes[p]));
  }
  if (masks != nullptr) {
    std::atomic<std::uint32_t>* const to = MasksAt(id);
    store(to[0], masks->category);
    store(to[1], masks->category >> 32);
    store(to[2], masks->collides_with);
    store(to[3], masks->collides_with >> 32);
  }
  words[0].store(
      ((before + kOneWrite) & ~(kOneWrite - 1)) | (is_present ? kPresent : 0),
      std::memory_order_release);
}

void Bodies::Move(Span<const std::uint32_t> ids, const float* planes) {
  WithAxes(planes_ / 2, [&](auto axes) {
    constexpr std::size_t kPlanes = 2 * decltype(axes)::value;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      std::atomic<std::uint32_t>* const words = At(ids[i]);
      const std::uint32_t before = words[0].load(std::memory_order_relaxed);
      words[0].store(before | kIsWritten, std::memory_order_relaxed);
      for (std::size_t p = 0; p < kPlanes; ++p) {
        words[1 + p].store(
            std::bit_cast<std::uint32_t>(planes[i * kPlanes + p]),
            std::memory_order_release);
      }
      words[0].store(before + kOneWrite, std::memory_order_release);
      Touch(ids[i]);
    }
  });
}

bool Version::HasReaders() const {
  std::uint32_t readers = 0;
  for (const Counter& counter : counters_) {
    readers |= counter.readers.load(std::memory_order_seq_cst);
  }
  return readers != 0;
}

std::size_t Version::NewCounter() {
  static constinit std::atomic<std::size_t> threads{0};
  const std::size_t thread = threads.fetch_add(1, std::memory_order_relaxed);
  const std::size_t counter =
      thread < kOwnCounters ? thread : kOwnCounters + thread % kOwnCounters;
  counter_of_thread_ = counter + 1;
  return counter;
}

bool Version::IsPending(std::uint32_t id) const {
  for (std::size_t i = PendingCount(); i-- > 0;) {
    if (Pending(i) == id) return true;
  }
  return false;
}

void Version::AddPending(std::uint32_t id) {
  const std::uint32_t count = pending_count_.load(std::memory_order_relaxed);
  pending_[count].store(id, std::memory_order_relaxed);
  pending_count_.store(count + 1, std::memory_order_release);
}

// The nodes first, from the root on: a walk that sees the body's new bound sees
// those of its nodes.
void Version::Widen(std::uint32_t id, const float* planes, bool is_mover) {
  SetOwnBound(id, false);
  const BvhLevels& levels = tree.levels();
  const std::size_t slot = levels.slots[id];
  WithAxes(tree.type().axes, [&](auto axes) {
    constexpr std::size_t kAxes = decltype(axes)::value;
    float* const leaf = &levels.level[0].Value(0, slot);
    float outward[2 * kAxes];
    for (std::size_t k = 0; k < kAxes; ++k) {
      outward[k] = NumberOf(planes[k], false);
      outward[kAxes + k] = NumberOf(planes[kAxes + k], true);
    }
    const unsigned beyond = BeyondOf<kAxes>(leaf, outward);
    // If the tree was copied during a Move(), a plane of the body can be
    // outside the planes of its nodes.
    for (std::size_t k = 0; k < kAxes; ++k) {
      const std::size_t max = kAxes + k;
      outward[k] = std::min(outward[k], LoadPlane(leaf[k * kBlockObjects]));
      outward[max] =
          std::max(outward[max], LoadPlane(leaf[max * kBlockObjects]));
    }
    for (std::size_t l = levels.count; l-- > 1;) {
      float* const node = &levels.level[l].Value(0, slot >> (6 * l));
      for (unsigned bits = BeyondOf<kAxes>(node, outward); bits != 0;
           bits &= bits - 1) {
        const auto p = static_cast<std::size_t>(std::countr_zero(bits));
        MoveOutward(node[p * kBlockObjects], outward[p], p >= kAxes);
      }
    }
    for (unsigned bits = beyond; bits != 0; bits &= bits - 1) {
      const auto p = static_cast<std::size_t>(std::countr_zero(bits));
      float& plane = leaf[p * kBlockObjects];
      if (is_mover) {
        // As in MoveOutward().
        std::atomic_ref<float>(plane).store(outward[p],
                                            std::memory_order_release);
      } else {
        MoveOutward(plane, outward[p], p >= kAxes);
      }
    }
  });
}

void Version::CopyOwnBounds(const Version& from, std::size_t count) {
#ifndef HALFSPACE_THREAD_SANITIZER  // which knows no fences
  // The floats of the tree were loaded before. If one of them is new, the mark
  // is seen to be taken away.
  std::atomic_thread_fence(std::memory_order_acquire);
#endif
  const std::size_t end = std::min(count, own_bound_count_);
  for (std::size_t id = 0; id < end; ++id) {
    own_bounds_[id].store(from.own_bounds_[id].load(std::memory_order_relaxed),
                          std::memory_order_relaxed);
  }
}

float* Version::Find(std::uint32_t id) const {
  return FindPlanes(tree.levels(), tree.id_limit(), id);
}

std::uint64_t Version::NotEnclosed(Span<const std::uint32_t> ids,
                                   const float* planes) const {
  const BvhLevels& levels = tree.levels();
  const std::size_t id_limit = tree.id_limit();
  return WithAxes(tree.type().axes, [&](auto axes) {
    constexpr std::size_t kAxes = decltype(axes)::value;
    float* of_tree[64];
    for (std::size_t i = 0; i < ids.size(); ++i) {
      of_tree[i] = FindPlanes(levels, id_limit, ids[i]);
      if (!levels.level[0].is_prefetched || of_tree[i] == nullptr) continue;
      for (std::size_t p = 0; p < 2 * kAxes; ++p) {
        kernels::Prefetch(of_tree[i] + p * kBlockObjects);
      }
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const bool is_enclosed =
          of_tree[i] != nullptr &&
          PlanesEnclose<kAxes>(of_tree[i], planes + 2 * kAxes * i);
      bits |= std::uint64_t{!is_enclosed} << i;
    }
    return bits;
  });
}

bool Version::DoAllEnclose(std::uint32_t id, const float* planes) const {
  const BvhLevels& levels = tree.levels();
  const BvhType& shape = tree.type();
  return dispatch::InDefaultFpMode([&] {
    for (std::size_t l = 0; l < levels.count; ++l) {
      const std::size_t node = levels.slots[id] >> (6 * l);
      for (std::size_t p = 0; p < shape.plane_count; ++p) {
        const bool is_max = p >= shape.axes;
        if (IsBeyond(NumberOf(planes[p], is_max),
                     LoadPlane(levels.level[l].Value(p, node)), is_max)) {
          return false;
        }
      }
    }
    return true;
  });
}

BroadPhaseState::BroadPhaseState(const BvhType& tree_shape, std::size_t ids,
                                 const BroadPhaseOptions& with)
    : shape(tree_shape),
      max_ids(ids),
      options(with),
      has_margin(IsMargin(with.margin)),
      bodies(with.memory, ids, 2u * tree_shape.axes),
      current(nullptr),
      candidates(with.memory) {
  current.store(NewVersion());
}

BroadPhaseState::~BroadPhaseState() {
  while (versions != nullptr) {
    Version* const version = versions;
    versions = version->next;
    version->~Version();
    FreeBlock(options.memory, version, BytesOfVersion());
  }
}

// One that no reader holds, or a new one.
Version* BroadPhaseState::NewVersion() {
  for (Version* v = versions; v != nullptr; v = v->next) {
    if (v != current.load() && !v->HasReaders()) return v;
  }
  void* const block = AllocateBlock(options.memory, BytesOfVersion());
  auto* const version =
      new (block) Version(BvhTree(shape, options.memory), MarksOfVersion());
  version->next = versions;
  versions = version;
  return version;
}

// A body that leaves its bound on one side went there from the other side,
// where the bound still is. The bound grows by as much again on the side to
// which the body moves, so that it stays inside about as long as before.
void BroadPhaseState::Loosen(float* in_tree, const float* planes,
                             float* loose) const {
  WithAxes(shape.axes, [&](auto axes) {
    constexpr std::size_t kAxes = decltype(axes)::value;
    for (std::size_t k = 0; k < kAxes; ++k) {
      const float margin =
          options.margin * static_cast<float>(k < shape.dims ? 1 : shape.dims);
      const std::size_t max = kAxes + k;
      float below = margin;
      float above = margin;
      if (has_margin && in_tree != nullptr) {
        const float from_min =
            planes[k] - LoadPlane(in_tree[k * kBlockObjects]);
        const float from_max =
            LoadPlane(in_tree[max * kBlockObjects]) - planes[max];
        // Without branches, which nothing predicts. Of a NaN, 0.
        const float way = std::max(from_min, from_max) - margin;
        const float ahead =
            std::min(way > 0 ? kShareAhead * way : 0.0f, kMostAhead * margin);
        below += from_max > from_min ? ahead : 0.0f;
        above += from_min > from_max ? ahead : 0.0f;
      }
      loose[k] = NumberOf(planes[k] - below, false);
      loose[max] = NumberOf(planes[max] + above, true);
    }
  });
}

void BroadPhaseState::CheckList(const char* call, Span<const std::uint32_t> ids,
                                const char* name, const void* others,
                                std::size_t other_count,
                                std::size_t alignment) const {
  if (other_count != ids.size()) {
    dispatch::ThrowInvalid(call, name,
                           "one for each id, " + std::to_string(ids.size()),
                           std::to_string(other_count));
  }
  CheckIds(call, ids);
  dispatch::CheckMemory(call, name, others, other_count, alignment);
}

void BroadPhaseState::CheckIds(const char* call,
                               Span<const std::uint32_t> ids) const {
  dispatch::CheckMemory(call, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
}

void BroadPhaseState::ThrowTaken(const char* call,
                                 Span<const std::uint32_t> ids,
                                 std::size_t i) const {
  dispatch::ThrowInvalid(
      call, "ids",
      ids[i] < max_ids ? "an id that no body has, once in the list"
                       : "an id below max_ids, " + std::to_string(max_ids),
      std::to_string(ids[i]), i);
}

std::size_t BroadPhaseState::FindAbsent(Span<const std::uint32_t> ids) const {
  std::size_t i = 0;
  while (i < ids.size() && ids[i] < max_ids && bodies.Has(ids[i])) ++i;
  return i;
}

void BroadPhaseState::ThrowAbsent(const char* call,
                                  Span<const std::uint32_t> ids,
                                  std::size_t i) const {
  dispatch::ThrowInvalid(call, "ids", "the id of a body",
                         std::to_string(ids[i]), i);
}

void BroadPhaseState::CheckBodies(const char* call,
                                  Span<const std::uint32_t> ids) const {
  CheckIds(call, ids);
  const std::size_t absent = FindAbsent(ids);
  if (absent != ids.size()) ThrowAbsent(call, ids, absent);
}

// By bits, as a compare with a NaN may trap.
void CheckMargin(const char* call, const char* name, float margin) {
  if (!IsMargin(margin) || std::bit_cast<std::uint32_t>(margin) < 0x7F800000) {
    return;
  }
  dispatch::ThrowInvalid(call, name, "a finite number that is not negative",
                         dispatch::Shortest(margin));
}

void TakenMarks::Take() {
  words_.Resize((state_.id_limit + 63) / 64, 0);
  for (std::size_t w = 0; w < words_.size(); ++w) {
    words_[w] = state_.bodies.TakeMoved(w);
  }
}

TakenMarks::~TakenMarks() {
  if (is_kept_) return;
  ForEach([&](std::uint32_t id) { state_.bodies.AddMark(id, Bodies::kMoved); });
}

BroadPhaseCore::BroadPhaseCore(const BvhType& shape, std::size_t max_ids,
                               const BroadPhaseOptions& options) {
  constexpr const char* kCall = "BroadPhase";
  if (max_ids > kMostIds) {
    dispatch::ThrowInvalid(kCall, "max_ids", "at most 2^29 ids",
                           std::to_string(max_ids));
  }
  CheckMargin(kCall, "options.margin", options.margin);
  // Calls with the mutex have no other reason to refuse.
  std::ignore = KernelsFor(shape, Target(), kCall);
  struct Block {
    explicit Block(const MemoryResource& of)
        : memory(of), state(AllocateBlock(of, sizeof(BroadPhaseState))) {}
    ~Block() {
      if (state != nullptr) FreeBlock(memory, state, sizeof(BroadPhaseState));
    }
    const MemoryResource& memory;
    void* state;
  } block(options.memory);
  BvhType without_codes = shape;
  without_codes.has_codes = false;
  state_ = new (block.state) BroadPhaseState(without_codes, max_ids, options);
  block.state = nullptr;
}

BroadPhaseCore::~BroadPhaseCore() {
  const MemoryResource memory = state_->options.memory;
  state_->~BroadPhaseState();
  FreeBlock(memory, state_, sizeof(BroadPhaseState));
}

std::size_t BroadPhaseCore::max_ids() const { return state_->max_ids; }

std::size_t BroadPhaseCore::size() const {
  return state_->size.load(std::memory_order_relaxed);
}

bool BroadPhaseCore::Has(std::uint32_t id) const {
  return id < state_->max_ids && state_->bodies.Has(id);
}

void BroadPhaseCore::Get(std::uint32_t id, Span<float> values) const {
  state_->CheckBodies("BroadPhase::Get", {&id, 1});
  Body body;
  if (!state_->bodies.Read(id, body)) {
    state_->ThrowAbsent("BroadPhase::Get", {&id, 1}, 0);
  }
  std::copy_n(body.planes, values.size(), values.data());
}

BodyMasks BroadPhaseCore::MasksOf(std::uint32_t id) const {
  state_->CheckBodies("BroadPhase::MasksOf", {&id, 1});
  Body body;
  if (!state_->bodies.Read(id, body)) {
    state_->ThrowAbsent("BroadPhase::MasksOf", {&id, 1}, 0);
  }
  return body.masks;
}

void BroadPhaseCore::Bounds(Span<float> values) const {
  const Held version(*state_);
  const WithRacyReads reads;
  dispatch::InDefaultFpMode([&] {
    version->tree.Bounds(values);
    for (std::size_t i = 0; i < version->PendingCount(); ++i) {
      Body body;
      if (!state_->bodies.Read(version->Pending(i), body)) continue;
      for (std::size_t p = 0; p < values.size(); ++p) {
        const bool is_max = p >= state_->shape.axes;
        const float plane = NumberOf(body.planes[p], is_max);
        if (IsBeyond(plane, values[p], is_max)) values[p] = plane;
      }
    }
  });
}

bool BroadPhaseCore::Validate() const {
  const std::scoped_lock lock(state_->mutex);
  const Version& version = *state_->current.load();
  std::size_t count = 0;
  for (std::size_t i = 0; i < state_->max_ids; ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    const bool is_pending = version.IsPending(id);
    Body body;
    if (!state_->bodies.Read(id, body)) continue;
    ++count;
    if (i >= state_->id_limit || is_pending == version.tree.Has(id)) {
      return false;
    }
    if (!is_pending && !version.DoAllEnclose(id, body.planes)) return false;
  }
  return count == size();
}

BroadPhaseStatistics BroadPhaseCore::Statistics() const {
  const std::scoped_lock lock(state_->mutex);
  const Version& version = *state_->current.load();
  BroadPhaseStatistics statistics;
  statistics.bodies = size();
  for (std::size_t i = 0; i < version.PendingCount(); ++i) {
    statistics.pending += state_->bodies.Has(version.Pending(i)) ? 1 : 0;
  }
  statistics.pairs = state_->pairs;
  statistics.bytes = sizeof(BroadPhaseState) + state_->bodies.bytes() +
                     state_->candidates.capacity();
  for (const Version* v = state_->versions; v != nullptr; v = v->next) {
    statistics.trees += v == &version || v->tree.bytes() > 0 ? 1 : 0;
    statistics.bytes += state_->BytesOfVersion() + v->tree.bytes();
  }
  const WithRacyReads reads;
  statistics.cost_ratio = version.tree.CostRatio();
  return statistics;
}

}  // namespace halfspace::detail
