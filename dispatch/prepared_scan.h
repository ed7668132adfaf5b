// A scan whose arguments have been checked, with the kernels that it needs:
// what the calls of reject.h and reject_many.h share.
#ifndef HALFSPACE_DISPATCH_PREPARED_SCAN_H_
#define HALFSPACE_DISPATCH_PREPARED_SCAN_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dispatch/kernel_table.h"
#include "dispatch/registry.h"
#include "dispatch/scan_errors.h"
#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"
#include "kernels/mask_job.h"

namespace halfspace::dispatch {

// Some queries of a scan, ready for the kernels.
struct QueryBlock {
  std::size_t first;
  std::size_t count;
  const void* elements;  // what the kernels read: floats, doubles or codes
};

class PreparedScan {
 public:
  // Throws std::invalid_argument in the name of `call`. An empty world resolves
  // its target too, so that a bad one is an error whatever the size.
  PreparedScan(const detail::Scan& scan, const Options& options,
               std::string_view call)
      : scan_(scan),
        call_(call),
        begin_(std::min(options.range.begin, scan.size)),
        end_(std::min(options.range.end, scan.size)),
        is_far_(scan.query_count == 1 &&
                (end_ - begin_) * RecordBytes() > kernels::kNearBytes) {
    if (MayBeBad(scan)) [[unlikely]]
      RefuseBadWorld(scan, call);
    if (options.range.begin % 64 != 0 ||
        options.range.begin > options.range.end ||
        (options.range.end % 64 != 0 && options.range.end < scan.size))
        [[unlikely]] {
      RefuseBadRange(scan, options.range, call);
    }
    if (options.schedule > Schedule::kStagedByAxis) [[unlikely]] {
      RefuseBadSchedule(options.schedule, call);
    }
    table_ = &KernelsFor(options.target, scan.dims, call);
    variant_ = kVariantOf[Index(scan.shape)][Index(options.schedule)];
  }

  const detail::Scan& scan() const { return scan_; }
  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }
  std::size_t query_count() const { return scan_.query_count; }
  bool is_coded() const { return scan_.book != nullptr; }
  bool is_confirmed() const { return scan_.is_confirmed; }
  const KernelTable& table() const { return *table_; }

  // Bytes of one object in the planes that the kernels read.
  std::size_t RecordBytes() const { return scan_.record_bytes; }

  // Throws unless an output of `bytes` lies outside every plane and query, and
  // is aligned. No bytes are always right.
  void CheckOutput(std::string_view argument, const void* begin,
                   std::size_t bytes, std::size_t alignment) const {
    if (bytes != 0 && MayBeBad(begin, bytes, alignment)) [[unlikely]] {
      RefuseBadOutput(scan_, call_, argument, begin, bytes, alignment);
    }
  }

  // Throws if there are more than 2^32 objects or queries.
  void CheckIndicesFit() const;

  // Writes the words of objects begin ... end - 1, begin a multiple of 64, for
  // queries first ... first + count - 1 of a block. Query q's words begin at
  // rows + q * stride; `flip` is 0 for reject masks, ~0 for survivor masks.
  // Returns the target's bit.
  std::int64_t Run(const QueryBlock& block, std::size_t first,
                   std::size_t count, std::size_t begin, std::size_t end,
                   std::uint64_t* rows, std::size_t stride,
                   std::uint64_t flip) const {
    return RunKernel(variant_, block, first, count, begin, end, rows, stride,
                     flip);
  }

  // Whether the first stage alone leaves so few candidates, as a rule, that
  // floats test them sooner than more codes: two stages of codes out of the
  // caches are another four lines for each live word.
  bool HasFirstStage() const {
    return scan_.is_confirmed && variant_ == kAaboBySimplex;
  }

  // As Run, with the survivors of the first stage alone.
  std::int64_t RunFirstStage(const QueryBlock& block, std::size_t first,
                             std::size_t count, std::size_t begin,
                             std::size_t end, std::uint64_t* rows,
                             std::size_t stride) const {
    return RunKernel(kAaboUp, block, first, count, begin, end, rows, stride,
                     ~std::uint64_t{0});
  }

  // Asks for share `share` of `shares` of the planes of objects begin ...
  // begin + objects - 1, as far as there are any. A tile that the queries come
  // to piece by piece would come out of memory line by line.
  void PrefetchTile(std::size_t begin, std::size_t objects, std::size_t share,
                    std::size_t shares) const;

  // Calls visit(block) for all queries in order; at least once, so that the
  // target is known where there are none.
  template <typename Visit>
  void ForEachBlock(const Visit& visit) const {
    if (scan_.book == nullptr) {
      visit(QueryBlock{0, scan_.query_count, scan_.queries});
    } else {
      ForEachCodedBlock(visit);
    }
  }

 private:
  // Codes are made once for all tiles of the world, and so in blocks: enough
  // queries that reading the world again for the next block costs nothing.
  static constexpr std::size_t kBlockQueries = 256;

  // The measured defaults are those of kAuto; docs/design.md says why.
  static constexpr Variant kVariantOf[3][4] = {
      // kAuto, kFlat, kStaged, kStagedByAxis
      {kSimplexFlat, kSimplexFlat, kSimplexByAxis, kSimplexByAxis},
      {kAabbFlat, kAabbFlat, kAabbByAxis, kAabbByAxis},
      {kAaboBySimplex, kAaboFlat, kAaboBySimplex, kAaboByAxis},
  };

  std::int64_t RunKernel(Variant variant, const QueryBlock& block,
                         std::size_t first, std::size_t count,
                         std::size_t begin, std::size_t end,
                         std::uint64_t* rows, std::size_t stride,
                         std::uint64_t flip) const {
    return table_->mask[Index(scan_.element)][variant](
        {.planes = scan_.planes.data(),
         .queries = static_cast<const std::byte*>(block.elements) +
                    first * RecordBytes(),
         .query_count = count,
         .begin = begin,
         .end = end,
         .rows = rows,
         .stride = stride,
         .flip = flip,
         .is_far = is_far_,
         .is_aligned = scan_.addresses.bits % kernels::kPlaneAlignment == 0});
  }

  template <typename Enum>
  static std::size_t Index(Enum value) {
    return static_cast<std::size_t>(value);
  }

  // Whether something may be wrong: a few cycles, where what is wrong takes a
  // look at each plane. Codes have planes of floats too, and are looked at.
  static bool MayBeBad(const detail::Scan& scan) {
    const auto queries = reinterpret_cast<std::uintptr_t>(scan.queries);
    const bool bad_queries =
        queries == 0 || (queries & (scan.query_bytes - 1u)) != 0;
    const bool bad_planes =
        scan.addresses.lowest == 0 ||
        (scan.addresses.bits & (scan.element_bytes - 1u)) != 0 ||
        scan.size >> 60 != 0;
    return bad_queries || bad_planes || scan.is_confirmed;
  }

  bool MayBeBad(const void* output, std::size_t bytes,
                std::size_t alignment) const {
    const auto begin = reinterpret_cast<std::uintptr_t>(output);
    const auto queries = reinterpret_cast<std::uintptr_t>(scan_.queries);
    const std::size_t query_bytes =
        scan_.query_count * scan_.plane_count * scan_.query_bytes;
    // Planes often lie in one block, and outputs outside it. Differences wrap.
    const std::size_t world_bytes = scan_.addresses.highest -
                                    scan_.addresses.lowest +
                                    scan_.size * scan_.element_bytes;
    return begin == 0 || (begin & (alignment - 1)) != 0 ||
           begin - scan_.addresses.lowest < world_bytes ||
           scan_.addresses.lowest - begin < bytes ||
           begin - queries < query_bytes || queries - begin < bytes ||
           scan_.is_confirmed;
  }

  template <typename Visit>
  void ForEachCodedBlock(const Visit& visit) const {
    alignas(16) std::byte
        codes[kBlockQueries * detail::kMaxPlanes * sizeof(std::int16_t)];
    std::size_t first = 0;
    do {
      visit(CodedBlock(first, codes));
      first += kBlockQueries;
    } while (first < scan_.query_count);
  }

  QueryBlock CodedBlock(std::size_t first, std::byte* codes) const;

  const detail::Scan& scan_;
  std::string_view call_;
  std::size_t begin_;
  std::size_t end_;
  bool is_far_;
  const KernelTable* table_;
  Variant variant_;
};

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_PREPARED_SCAN_H_
