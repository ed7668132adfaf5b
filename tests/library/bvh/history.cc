#include "tests/library/bvh/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "halfspace/error.h"

namespace halfspace::testing {

Choices::Choices(const Layout& layout, Random& random, bool may_trap)
    : layout_(layout),
      may_trap_(may_trap),
      random_(random),
      small_(layout, 1, random()),
      large_(layout, 15, random()),
      coincident_(small_.Next()),
      last_(coincident_) {}

Planes Choices::Next() {
  Planes bound = small_.Next();
  const std::size_t plane = random_() % layout_.plane_count;
  switch (random_() % 24) {
    case 0:
      return EverythingOf(layout_);
    case 1:
      return EmptyOf(layout_);
    case 2:  // a wall, or half of one
      bound[plane] = IsMin(layout_, plane) ? -kInf : kInf;
      if (layout_.has_max && plane % 2 == 0) {
        bound[plane % layout_.axes] = -kInf;
        bound[layout_.axes + plane % layout_.axes] = kInf;
      }
      return bound;
    case 3:  // all at infinity
      std::fill_n(bound.begin(), layout_.plane_count, kInf);
      return bound;
    case 4:
      bound[plane] = kNan;
      return bound;
    case 5:
      if (!may_trap_) bound[plane] = SpecialValue<float>(random_);
      return bound;
    case 6:  // inverted
      if (layout_.has_max) std::swap(bound[0], bound[layout_.first_max]);
      return bound;
    case 7:
      return large_.Next();
    case 8:
    case 9:
      return coincident_;
    case 10:  // some planes of another bound, or one ulp beside them
      for (std::size_t p = 0; !may_trap_ && p < layout_.plane_count; ++p) {
        const std::size_t how = random_() % 4;
        if (how < 3) bound[p] = last_[p];
        if (how > 0)
          bound[p] = std::nextafter(bound[p], how == 1 ? kInf : -kInf);
      }
      return bound;
    default:
      last_ = bound;
      return bound;
  }
}

Planes Choices::Moved(const Planes& bound) {
  if (random_() % 4 == 0) return Next();
  Planes moved = bound;
  for (std::size_t k = 0; k < layout_.axes; ++k) {
    const float step = static_cast<float>(random_() % 100) / 200 - 0.25f;
    moved[k] += step;
    if (layout_.has_max) moved[layout_.first_max + k] += step;
  }
  return moved;
}

BodyMasks Choices::Masks() {
  constexpr std::uint32_t kBits[] = {0, 1, 2, std::uint32_t{1} << 31};
  BodyMasks masks;
  if (random_() % 3 == 0) masks.category = kBits[random_() % 4];
  if (random_() % 3 == 0) masks.collides_with = 1 | kBits[random_() % 4];
  return masks;
}

void RunOnThreads(std::size_t count, const Runner::Part& part) {
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 3; ++t) {
    threads.emplace_back([t, count, &part] {
      for (std::size_t i = t; i < count; i += 3) part(count - 1 - i);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

BoundList InDoubles(const Layout& layout, std::vector<Planes> floats) {
  BoundList list(std::move(floats));
  for (const Planes& bound : list.floats) {
    auto& doubles = list.doubles.emplace_back();
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      const double value = bound[p];
      // Halfway to the next float inside.
      const double next =
          std::nextafter(bound[p], IsMin(layout, p) ? kInf : -kInf);
      doubles[p] = value != 0 && std::isfinite(value) && std::isfinite(next)
                       ? value + (next - value) / 2
                       : value;
    }
  }
  return list;
}

BvhHistory::BvhHistory(const Layout& layout, Choices& choices, std::size_t size,
                       std::size_t most, FpMode mode, CountingMemory* memory)
    : layout_(layout),
      choices_(choices),
      most_(most),
      mode_(mode),
      memory_(memory) {
  const BoundList bounds = Bounds(size);
  const BuildOptions options{
      .quality =
          choices_.Below(2) == 0 ? BuildQuality::kHigh : BuildQuality::kFast,
      .memory = memory == nullptr ? MemoryResource() : memory->resource()};
  RunIn(mode_, [&] { all_.push_back(MakeBvh(layout, bounds, options)); });
  for (std::uint32_t id = 0; id < size; ++id) Has(id, bounds.floats[id]);
}

std::size_t BvhHistory::Change() {
  const std::size_t what = choices_.Below(18);
  const std::size_t count =
      choices_.Below(8) == 0 ? choices_.Below(most_) : choices_.Below(20);
  switch (what) {
    case 0:
    case 1:
    case 2:
      Insert(count, what == 0);
      break;
    case 3:
      InsertAs(count);
      break;
    case 4:
    case 5:
      Erase(count, what == 4);
      break;
    case 6:
    case 7:
    case 8:
      Set(count, what - 6);
      break;
    case 9:
      RefitAll();
      break;
    case 10: {
      const std::size_t objects = choices_.Below(2 * most_);
      Each([&](AnyBvh& bvh) { (void)bvh.RebuildPartial(objects); });
      break;
    }
    case 11: {
      BuildOptions options{.quality = choices_.Below(2) == 0
                                          ? BuildQuality::kHigh
                                          : BuildQuality::kFast};
      Each([&](AnyBvh& bvh) {
        options.run = RunnerOf(bvh);
        bvh.Rebuild(options);
      });
      const std::size_t limit =
          objects_.empty() ? 0 : std::prev(objects_.end())->first + 1u;
      EXPECT_EQ(bvh().id_limit(), limit);
      break;
    }
    case 12:
    case 13:
      SetMasks(what == 12 ? count : 0);
      break;
    case 14:
      ReserveOrClear(count);
      break;
    case 15:
      CopyOrLoad();
      break;
    case 16:  // The copy goes on.
      if (all_.size() > 1) all_.erase(all_.begin());
      break;
    default:
      RefuseLists(count);
  }
  return what;
}

void BvhHistory::ExpectIsModel(const HowToAsk& how, Random& random) const {
  for (const auto& bvh : all_) {
    ASSERT_EQ(bvh->size(), objects_.size());
    // Without memory an insertion puts off the sort that is due.
    ASSERT_TRUE(memory_ != nullptr ||
                std::ranges::equal(bvh->ids(), all_[0]->ids()));
    ASSERT_LE(bvh->ids().size(), 2 * bvh->size() + 64);
    ASSERT_TRUE(bvh->Verify());
  }
  for (const Blob& blob : blobs_) {
    ASSERT_TRUE(std::ranges::equal(blob.bytes->bytes(), blob.untouched));
  }
  testing::ExpectIsModel(*all_[0], objects_, how, random);
}

Ids BvhHistory::TakeChanged() { return std::exchange(changed_, {}); }

Runner BvhHistory::RunnerOf(const AnyBvh& bvh) const {
  static auto run = RunOnThreads;
  return &bvh == all_[0].get() ? Runner() : Runner(run);
}

BoundList BvhHistory::Bounds(std::size_t count) {
  std::vector<Planes> floats(count);
  for (Planes& bound : floats) bound = choices_.Next();
  const bool is_of_doubles =
      layout_.kind == Layout::kAabb && choices_.Below(4) == 0;
  return is_of_doubles ? InDoubles(layout_, std::move(floats))
                       : BoundList(std::move(floats));
}

std::uint32_t BvhHistory::AnyId() {
  const std::size_t end = std::min<std::size_t>(bvh().id_limit(), 65536);
  auto it =
      objects_.lower_bound(static_cast<std::uint32_t>(choices_.Below(end)));
  return (it == objects_.end() ? objects_.begin() : it)->first;
}
Ids BvhHistory::AnyIds(std::size_t count) {
  Ids ids;
  while (!objects_.empty() && ids.size() < count) ids.push_back(AnyId());
  return ids;
}

void BvhHistory::Has(std::uint32_t id, const Planes& bound) {
  objects_[id] = {bound};
  changed_.push_back(id);
}

// Each gets the least id that is free.
void BvhHistory::Insert(std::size_t count, bool is_list) {
  const BoundList bounds = Bounds(count);
  Ids expected;
  std::uint32_t free = 0;
  for (const Planes& bound : bounds.floats) {
    while (objects_.contains(free)) ++free;
    expected.push_back(free);
    Has(free, bound);
  }
  for (std::size_t i = 0; !is_list && i < count; ++i) {
    Each([&](AnyBvh& bvh) {
      EXPECT_EQ(bvh.Insert(bounds.floats[i]), expected[i]);
    });
  }
  if (!is_list) return;
  Each([&](AnyBvh& bvh) {
    Ids ids(count);
    bvh.Insert(bounds, ids);
    EXPECT_EQ(ids, expected);
  });
}

// Free ids, some far beyond the others, in any order.
void BvhHistory::InsertAs(std::size_t count) {
  const std::size_t far = choices_.Below(8) == 0 ? 30'000 : 300;
  const std::size_t end = std::min<std::size_t>(bvh().id_limit() + far, 65536);
  std::map<std::uint32_t, bool> added;
  Ids ids;
  while (count-- > 0) {
    const auto id = static_cast<std::uint32_t>(choices_.Below(end));
    if (!objects_.contains(id) && !std::exchange(added[id], true)) {
      ids.push_back(id);
    }
  }
  const BoundList bounds = Bounds(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) Has(ids[i], bounds.floats[i]);
  Each([&](AnyBvh& bvh) { bvh.InsertAs(ids, bounds); });
}

// An id may be twice in a list.
void BvhHistory::Erase(std::size_t count, bool is_list) {
  Ids ids = AnyIds(count);
  if (!is_list) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  }
  for (const std::uint32_t id : ids) {
    objects_.erase(id);
    changed_.push_back(id);
  }
  if (is_list) return Each([&](AnyBvh& bvh) { bvh.Erase(ids); });
  for (const std::uint32_t id : ids) {
    Each([&](AnyBvh& bvh) { bvh.Erase(id); });
  }
}

// One by one, by a list, or by a list of ids and the bounds by id. Of ids that
// come twice the last bound counts.
void BvhHistory::Set(std::size_t count, std::size_t how) {
  const Ids ids = AnyIds(count);
  BoundList bounds = Bounds(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Planes& bound = bounds.floats[i];
    if (bounds.doubles.empty() && choices_.Below(2) == 0) {
      bound = choices_.Moved(objects_.at(ids[i]).bound);
    }
    objects_.at(ids[i]).bound = bound;
    changed_.push_back(ids[i]);
  }
  BoundList by_id;
  if (how == 2) {
    by_id.floats.assign(bvh().id_limit(), EverythingOf(layout_));
    for (const std::uint32_t id : ids) by_id.floats[id] = objects_.at(id).bound;
  }
  if (how == 1) return Each([&](AnyBvh& bvh) { bvh.Set(ids, bounds); });
  if (how == 2) return Each([&](AnyBvh& bvh) { bvh.Refit(ids, by_id); });
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Each([&](AnyBvh& bvh) { bvh.Set(ids[i], bounds.floats[i]); });
  }
}

void BvhHistory::RefitAll() {
  const bool is_in_order = choices_.Below(2) == 0;
  const auto places = bvh().ids();
  const std::size_t size = is_in_order ? places.size() : bvh().id_limit();
  BoundList bounds = Bounds(size);
  for (std::size_t i = 0; i < size; ++i) {
    const auto id = is_in_order ? places[i] : static_cast<std::uint32_t>(i);
    const auto it = objects_.find(id);
    if (it == objects_.end()) continue;
    it->second.bound = bounds.floats[i];
    changed_.push_back(id);
  }
  Each([&](AnyBvh& bvh) { bvh.Refit(bounds, !is_in_order, RunnerOf(bvh)); });
}

// Of some objects, or of all.
void BvhHistory::SetMasks(std::size_t count) {
  if (count > 0) {
    for (const std::uint32_t id : AnyIds(count)) {
      const auto masks = std::uint32_t{1} << choices_.Below(3);
      objects_.at(id).masks = masks;
      Each([&](AnyBvh& bvh) { bvh.SetMasks(id, masks); });
    }
    return;
  }
  Ids masks(bvh().id_limit());
  for (auto& [id, object] : objects_) {
    masks[id] = object.masks = static_cast<std::uint32_t>(choices_.Below(8));
  }
  Each([&](AnyBvh& bvh) { bvh.SetMasks(masks); });
}

void BvhHistory::ReserveOrClear(std::size_t count) {
  if (choices_.Below(3) == 0) {
    for (const auto& [id, object] : objects_) changed_.push_back(id);
    objects_.clear();
    Each([](AnyBvh& bvh) { bvh.Clear(); });
    // A blob in place has no room now. The other one has, and so another order
    // from now on.
    if (all_.front()->bytes() != all_.back()->bytes()) all_.erase(all_.begin());
    EXPECT_EQ(bvh().id_limit(), 0u);
  }
  Each([&](AnyBvh& bvh) { bvh.Reserve(objects_.size() + count); });
  std::vector<std::size_t> bytes;
  for (const auto& bvh : all_) bytes.push_back(bvh->bytes());
  Insert(count, choices_.Below(2) == 0);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    EXPECT_EQ(all_[i]->bytes(), bytes[i]) << "reserved too little";
  }
}

// From now on there is another one.
void BvhHistory::CopyOrLoad() {
  all_.resize(1);
  const std::size_t how = choices_.Below(3);
  const auto blob = bvh().Blob();
  const MemoryResource memory =
      memory_ == nullptr ? MemoryResource() : memory_->resource();
  if (how == 0) {
    all_.push_back(bvh().Copy());
  } else if (how == 1) {
    all_.push_back(LoadBvh(layout_, blob, false, memory));
  } else {
    blobs_.push_back(
        {std::make_unique<AlignedCopy>(blob), {blob.begin(), blob.end()}});
    all_.push_back(
        LoadBvh(layout_, blobs_.back().bytes->bytes(), true, memory));
  }
}

// Lists with one wrong id, which change nothing.
void BvhHistory::RefuseLists(std::size_t count) {
  if (mode_ == FpMode::kTraps || memory_ != nullptr || objects_.empty()) return;
  Ids ids = AnyIds(count);
  const std::size_t at = choices_.Below(count + 1);
  const bool is_insertion = choices_.Below(2) == 0;
  if (is_insertion) {  // among ids that are free
    const auto limit = static_cast<std::uint32_t>(bvh().id_limit());
    for (std::uint32_t& id : ids)
      id = limit + static_cast<std::uint32_t>(&id - ids.data());
  }
  std::uint32_t wrong = AnyId();
  if (!is_insertion) {
    while (objects_.contains(wrong)) ++wrong;
  }
  ids.insert(ids.begin() + static_cast<std::ptrdiff_t>(at), wrong);
  const BoundList bounds = Bounds(ids.size());
  Each([&](AnyBvh& bvh) {
    if (is_insertion) {
      EXPECT_THROW(bvh.InsertAs(ids, bounds), Error);
    } else {
      EXPECT_THROW(bvh.Set(ids, bounds), Error);
      EXPECT_THROW(bvh.Erase(ids), Error);
    }
  });
}

}  // namespace halfspace::testing
