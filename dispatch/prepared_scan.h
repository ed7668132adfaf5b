// A scan whose arguments have been checked, with the kernels that it needs:
// what the calls of reject.h and reject_many.h share.
#ifndef HALFSPACE_DISPATCH_PREPARED_SCAN_H_
#define HALFSPACE_DISPATCH_PREPARED_SCAN_H_

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dispatch/kernel_table.h"
#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"

namespace halfspace::dispatch {

// Some queries of a scan, ready for the kernels.
struct QueryBlock {
  std::size_t first;
  std::size_t count;
  const std::byte* elements;  // what the kernels read: floats or codes
  const float* floats;        // null unless the scan is confirmed
};

class PreparedScan {
 public:
  // Throws std::invalid_argument in the name of `call`. An empty world resolves
  // its target too, so that a bad one is an error whatever the size.
  PreparedScan(const detail::Scan& scan, const Options& options,
               std::string_view call);

  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }
  std::size_t world_size() const { return scan_.size; }
  std::size_t query_count() const { return scan_.query_count; }
  bool is_confirmed() const { return scan_.is_confirmed; }

  // Bytes of one object in the planes that the kernels read.
  std::size_t RecordBytes() const;

  // Throws unless an output of `bytes` lies outside every plane and query, and
  // is aligned. No bytes are always right.
  void CheckOutput(std::string_view argument, const void* begin,
                   std::size_t bytes, std::size_t alignment) const;

  // Throws if there are more than 2^32 objects or queries.
  void CheckIndicesFit() const;

  // Writes the words of objects begin ... end - 1, begin a multiple of 64, for
  // queries first ... first + count - 1 of a block. Returns the target's bit.
  std::int64_t Run(const QueryBlock& block, std::size_t first,
                   std::size_t count, std::size_t begin, std::size_t end,
                   std::uint64_t* rows, std::size_t stride,
                   std::uint64_t flip) const;

  std::size_t CountBits(const std::uint64_t* words, std::size_t count) const {
    return table_->count_bits(words, count);
  }

  // Calls visit(block) for all queries in order; at least once, so that the
  // target is known where there are none.
  template <typename Visit>
  void ForEachBlock(const Visit& visit) const {
    // Codes are made once for all tiles of the world, and so in blocks: enough
    // queries that reading the world again for the next block costs nothing.
    alignas(16) std::byte
        codes[kBlockQueries * detail::kMaxPlanes * sizeof(std::int16_t)];
    std::size_t first = 0;
    do {
      visit(BlockOf(first, codes));
      first += kBlockQueries;
    } while (first < scan_.query_count);
  }

 private:
  static constexpr std::size_t kBlockQueries = 256;

  QueryBlock BlockOf(std::size_t first, std::byte* codes) const;
  void CheckWorld() const;
  void SetRange(const Range& range);

  const detail::Scan& scan_;
  std::string_view call_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  const KernelTable* table_;
  MaskKernel kernel_;
};

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_PREPARED_SCAN_H_
