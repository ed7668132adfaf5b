#include "bench/worlds/working_set.h"

#include <algorithm>
#include <utility>

#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kAaboBytes = 8 * sizeof(float);
constexpr std::size_t kSimplexBytes = 4 * sizeof(float);

std::size_t RoundDown(std::size_t value, std::size_t step) {
  return std::max(step, value / step * step);
}

// The reference is slow: on large worlds it answers fewer queries.
constexpr std::size_t kReferenceTests = 1 << 22;
constexpr std::size_t kMostChecked = 256;

}  // namespace

std::vector<WorkingSetSize> WorkingSetSizes(const Machine& machine) {
  std::vector<WorkingSetSize> sizes;
  for (int level = 1; level <= 3; ++level) {
    const std::size_t step = level == 1 ? 64 : kSetStep;
    const std::size_t bytes = machine.CacheBytes(level) / 2;
    WorkingSetSize size{"L" + std::to_string(level),
                        RoundDown(bytes / kAaboBytes, step), "", bytes};
    if (machine.are_caches_known() && !machine.HasCache(level)) {
      size.why_not_reached = "this machine has no such cache";
    }
    sizes.push_back(std::move(size));
  }
  // Virtual machines hide caches, and no core has more than 96 MiB of them.
  constexpr std::size_t kLeastMemory = std::size_t{256} << 20;
  const std::size_t bytes =
      std::max(4 * machine.LastLevelBytes(), kLeastMemory);
  const std::size_t wanted =
      RoundDown(bytes / kSimplexBytes, kSetStep) + kSetStep;
  WorkingSetSize memory{"memory", wanted, "", bytes};
  // What cannot be known is taken for enough for the smallest of machines.
  const std::size_t available = machine.available_memory == 0
                                    ? std::size_t{1} << 30
                                    : machine.available_memory;
  if (machine.is_emulated) {
    memory.why_not_reached =
        "takes long and means nothing where the CPU is emulated";
  } else if (wanted * kAaboBytes > available / 4) {
    memory.why_not_reached = "needs " + Mebibytes(wanted * kAaboBytes) +
                             ", more than a quarter of the " +
                             Mebibytes(available) + " that are free";
  }
  sizes.push_back(std::move(memory));
  return sizes;
}

WorkingSet::WorkingSet(const AaboWorld3& objects, std::vector<Aabo3> queries,
                       const WorkingSetSize& size)
    : name_(size.name),
      world_(ResizedTo(objects, size.objects)),
      view_(world_.view()),
      queries_(std::move(queries)),
      mask_(MaskWords(size.objects)),
      checked_queries_(
          std::clamp<std::size_t>(kReferenceTests / size.objects, 1,
                                  std::min(kMostChecked, queries_.size()))) {}

std::string WorkingSet::Check(ShapeKind shape, const WriteMask& write) {
  std::vector<std::uint64_t>& expected =
      expected_[static_cast<std::size_t>(shape)];
  if (expected.empty()) {
    expected.resize(mask_.size() * checked_queries_, 0);
    for (std::size_t q = 0; q < checked_queries_; ++q) {
      std::uint64_t* mask = &expected[q * mask_.size()];
      WithShape(shape, view_, queries_[q],
                [mask](const auto& view, const auto& query) {
                  reference::RejectMask(view, query, mask);
                });
    }
  }
  for (std::size_t q = 0; q < checked_queries_; ++q) {
    std::fill(mask_.begin(), mask_.end(), 0x5555555555555555);
    write(q);
    const auto first =
        expected.begin() + static_cast<std::ptrdiff_t>(q * mask_.size());
    const auto wrong = std::mismatch(mask_.begin(), mask_.end(), first).first;
    if (wrong != mask_.end()) {
      return "query " + std::to_string(q) + ", objects from " +
             std::to_string((wrong - mask_.begin()) * 64) +
             " on: the mask is not the scalar reference's";
    }
  }
  return {};
}

Case WorkingSet::MakeCase(std::string name, ShapeKind shape,
                          const WriteMask& write) {
  Case c = CaseOfQueries(std::move(name), queries_.size(), objects(), write);
  c.items *= static_cast<double>(objects());
  c.check = [this, shape, write] { return Check(shape, write); };
  return c;
}

Case WorkingSet::LibraryCase(std::string name, ShapeKind shape,
                             const Options& options) {
  return MakeCase(std::move(name), shape,
                  [this, shape, options](std::size_t q) {
                    WithShape(shape, view_, queries_[q],
                              [&](const auto& view, const auto& query) {
                                RejectMask(view, query, mask_, options);
                              });
                  });
}

Case WorkingSet::LoopCase(std::string name, ShapeKind shape, const Scan& scan) {
  return MakeCase(
      std::move(name), shape,
      [this, scan, shape, planes = PlanesOf(shape, view_)](std::size_t q) {
        const std::vector<float> query = QueryOf(shape, queries_[q]);
        scan(planes.data(), query.data(), objects(), mask_.data());
      });
}

Case WorkingSet::ReadCase(std::string name, ShapeKind shape, std::size_t turn,
                          Target target) const {
  const std::size_t rounds =
      std::max<std::size_t>(1, kObjectsPerRun / objects());
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(objects() * rounds);
  c.run = [read = LoopsFor(target).read, turn, rounds,
           planes = PlanesOf(shape, view_), bytes = objects() * sizeof(float)] {
    for (std::size_t i = 0; i < rounds; ++i) {
      KeepResult(read(turn, planes.data(), planes.size(), bytes));
    }
  };
  return c;
}

}  // namespace halfspace::bench
