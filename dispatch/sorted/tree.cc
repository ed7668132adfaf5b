// What a sorted world owns: its memory, and the build.
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/detail/block_memory.h"
#include "halfspace/detail/sorted.h"
#include "halfspace/sorted.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"
#include "kernels/sorted/block.h"
#include "kernels/sorted/order.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kLine = 64;

// More than this is not in the second-level cache.
constexpr std::size_t kInCacheBytes = std::size_t{1} << 20;

constexpr std::size_t BlocksOf(std::size_t objects) {
  return (objects + kBlockObjects - 1) / kBlockObjects;
}

std::size_t PlanesOf(const SortedShape& shape) {
  return shape.has_max ? 2u * shape.axes : shape.axes;
}

// Hands out parts of a tree, of whole cache lines; without memory it measures.
class Parts {
 public:
  explicit Parts(std::byte* begin) : begin_(begin) {}

  std::size_t bytes() const { return bytes_; }

  template <typename T>
  T* Take(std::size_t count) {
    auto* part =
        begin_ == nullptr ? nullptr : reinterpret_cast<T*>(begin_ + bytes_);
    bytes_ += (count * sizeof(T) + kLine - 1) / kLine * kLine;
    return part;
  }

 private:
  std::byte* begin_;
  std::size_t bytes_ = 0;
};

// Finds where the parts of a tree are in memory from `begin` on, all of which
// follows from the number of objects; returns their bytes.
std::size_t Place(const SortedShape& shape, std::size_t objects,
                  std::byte* begin, SortedLevels& levels) {
  constexpr std::size_t kStagger = 5 * kLine / sizeof(float);
  levels = {};
  const std::size_t planes = PlanesOf(shape);
  Parts parts(begin);
  std::size_t size = objects;
  do {
    SortedLevel& level = levels.level[levels.count++];
    level.size = size;
    const std::size_t blocks = BlocksOf(size);
    const std::size_t bytes = blocks * BlockBytes(planes);
    level.is_prefetched = bytes > kInCacheBytes;
    level.blocks = parts.Take<std::byte>(bytes);
    for (std::size_t p = 0; p < planes; ++p) {
      level.planes[p] = parts.Take<float>(blocks * kBlockObjects + kStagger);
    }
    if (levels.count > 1) level.regular = parts.Take<std::uint64_t>(blocks);
    size = blocks;
  } while (size > 1);
  levels.ids = parts.Take<std::uint32_t>(BlocksOf(objects) * kBlockObjects);
  return parts.bytes();
}

// Everything but the ids of the objects.
void Fill(const SortedShape& shape, const FloatColumns& objects,
          const SortedKernels::OfPlanes& of_planes,
          const SortedLevels& levels) {
  const std::size_t planes = PlanesOf(shape);
  std::fill(levels.ids + objects.size,
            levels.ids + BlocksOf(objects.size) * kBlockObjects, 0);
  for (std::size_t p = 0; p < planes; ++p) {
    float* const plane = levels.level[0].planes[p];
    for (std::size_t i = 0; i < objects.size; ++i) {
      plane[i] = objects.planes[p][levels.ids[i] * objects.stride];
    }
  }
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (std::size_t l = 0; l < levels.count; ++l) {
    const SortedLevel& level = levels.level[l];
    const std::size_t blocks = BlocksOf(level.size);
    for (std::size_t p = 0; p < planes; ++p) {
      std::fill(level.planes[p] + level.size,
                level.planes[p] + blocks * kBlockObjects,
                (p < shape.axes ? 1.0f : -1.0f) * kInf);
    }
    const bool is_top = l + 1 == levels.count;
    if (!is_top) {
      const SortedLevel& above = levels.level[l + 1];
      std::fill_n(above.regular, BlocksOf(above.size), 0);
    }
    of_planes.build(
        {&level, is_top ? nullptr : &levels.level[l + 1], 0, blocks});
  }
}

// Memory for the time of a build.
struct Scratch {
  Scratch(const MemoryResource& resource, std::size_t size)
      : memory(resource),
        bytes(size),
        begin(static_cast<std::byte*>(AllocateBlock(memory, bytes))) {}
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { FreeBlock(memory, begin, bytes); }

  MemoryResource memory;
  std::size_t bytes;
  std::byte* begin;
};

}  // namespace

SortedTree::SortedTree(const SortedShape& shape, const MemoryResource& memory)
    : shape_(shape), memory_(memory) {}

SortedTree::SortedTree(const SortedTree& other, const MemoryResource& memory)
    : SortedTree(other.shape_, memory) {
  if (other.block_ == nullptr) return;
  Allocate(other.size());
  std::memcpy(block_, other.block_, bytes_);
}

SortedTree::SortedTree(SortedTree&& other) noexcept
    : shape_(other.shape_), memory_(other.memory_) {
  std::swap(block_, other.block_);
  std::swap(bytes_, other.bytes_);
  std::swap(levels_, other.levels_);
}

SortedTree& SortedTree::operator=(const SortedTree& other) {
  return AssignCopy(*this, other);
}
SortedTree& SortedTree::operator=(SortedTree&& other) {
  return AssignMove(*this, other);
}

SortedTree::~SortedTree() { Free(); }

void SortedTree::Swap(SortedTree& other) noexcept {
  std::swap(shape_, other.shape_);
  std::swap(memory_, other.memory_);
  std::swap(block_, other.block_);
  std::swap(bytes_, other.bytes_);
  std::swap(levels_, other.levels_);
}

void SortedTree::Free() {
  if (block_ == nullptr) return;
  FreeBlock(memory_, block_, bytes_);
  block_ = nullptr;
  bytes_ = 0;
  levels_ = {};
}

// Replaces all by new memory. As it was if there is none.
void SortedTree::Allocate(std::size_t objects) {
  SortedLevels levels;
  const std::size_t bytes = Place(shape_, objects, nullptr, levels);
  auto* const block = static_cast<std::byte*>(AllocateBlock(memory_, bytes));
  Free();
  block_ = block;
  bytes_ = bytes;
  Place(shape_, objects, block_, levels_);
}

void SortedTree::Build(const FloatColumns& objects, Order order,
                       Target target) {
  constexpr const char* kCall = "SortedWorld";
  const std::size_t index = dispatch::IndexOf(target, kCall);
  const SortedKernels::OfPlanes& of_planes =
      shape_.has_max ? shape_.kernels[index].all : shape_.kernels[index].minima;
  const std::size_t planes = PlanesOf(shape_);
  if (objects.size > std::numeric_limits<std::uint32_t>::max()) {
    kernels::ThrowInvalid(kCall, "world", "less than 2^32 objects",
                          std::to_string(objects.size));
  }
  if (order != Order::kTight && order != Order::kFast) {
    kernels::ThrowInvalid(kCall, "order", "an enumerator of Order",
                          std::to_string(static_cast<int>(order)));
  }
  if (objects.size == 0) return Free();
  for (std::size_t p = 0; p < planes; ++p) {
    kernels::CheckPointer(
        kCall, objects.planes[p], alignof(float),
        [&] { return kernels::PlaneName("world", shape_.axes, p); },
        [&] {
          return "a plane of " + std::to_string(objects.size) + " floats";
        });
  }
  // More bytes than an object takes in all.
  kernels::CheckAddressable(kCall, "world", objects.size, 128);
  const Scratch scratch(memory_, objects.size * kernels::kOrderScratch);
  Allocate(objects.size);
  kernels::InDefaultFpMode([&] {
    const auto put_in_order =
        order == Order::kFast ? kernels::OrderByCurve : kernels::OrderByMedians;
    put_in_order(shape_, objects, scratch.begin, levels_.ids);
    Fill(shape_, objects, of_planes, levels_);
  });
}

}  // namespace halfspace::detail
