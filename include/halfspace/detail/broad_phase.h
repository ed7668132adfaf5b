// Internal. The calls of broad_phase.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_BROAD_PHASE_H_
#define HALFSPACE_DETAIL_BROAD_PHASE_H_

#include <cstddef>
#include <cstdint>
#include <utility>

#include "halfspace/detail/bvh.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/runner.h"
#include "halfspace/span.h"

namespace halfspace {

struct BodyMasks;
struct BroadPhaseOptions;
struct BroadPhaseStatistics;
struct UpdateOptions;

namespace detail {

// Writes bytes of Save().
using SaveFunction = void (*)(void* context, Span<const std::byte> bytes);

class BroadPhaseState;
class PairEventsCore;

class HALFSPACE_API BroadPhaseCore {
 public:
  BroadPhaseCore(const BvhType& type, const BroadPhaseOptions& options);
  BroadPhaseCore(const BroadPhaseCore& other);
  BroadPhaseCore(BroadPhaseCore&& other) noexcept : state_(other.state_) {
    other.state_ = nullptr;
  }
  // Two operators, as in PlaneStore. A copy has the options of its source, so
  // it does not keep its resource, and a move never copies.
  BroadPhaseCore& operator=(const BroadPhaseCore& other);
  BroadPhaseCore& operator=(BroadPhaseCore&& other) noexcept {
    BroadPhaseCore taken(std::move(other));
    std::swap(state_, taken.state_);
    return *this;
  }
  ~BroadPhaseCore();

  // Bound i has its values from values[i * planes] on: all minima, then all
  // maxima.
  void Insert(Span<const std::uint32_t> ids, Span<const float> values,
              Span<const BodyMasks> masks);
  void Erase(Span<const std::uint32_t> ids);
  void Move(Span<const std::uint32_t> ids, Span<const float> values);
  void SetMasks(Span<const std::uint32_t> ids, Span<const BodyMasks> masks);
  void Update(const UpdateOptions& options);
  void Rebuild(const Runner& run);

  std::size_t size() const;
  std::size_t id_limit() const;
  bool Has(std::uint32_t id) const;
  void Get(std::uint32_t id, Span<float> values) const;
  BodyMasks MasksOf(std::uint32_t id) const;
  void Bounds(Span<float> values) const;
  bool Validate() const;
  BroadPhaseStatistics Statistics() const;
  const PairEventsCore& events() const;
  void Save(SaveFunction function, void* context) const;
  void Load(Span<const std::byte> bytes);

  std::size_t Survivors(const BvhQueries& query, Span<std::uint32_t> ids,
                        const QueryOptions& options, std::size_t skip) const;
  std::size_t Count(const BvhQueries& query, const QueryOptions& options) const;
  bool Any(const BvhQueries& query, std::uint32_t& id,
           const QueryOptions& options) const;
  void ForEach(const BvhQueries& query, IdsFunction function, void* context,
               const QueryOptions& options) const;
  std::size_t SurvivorsOfEach(const BvhQueries& queries,
                              Span<std::uint32_t> ids,
                              Span<std::size_t> offsets,
                              const QueryOptions& options,
                              std::size_t skip) const;
  std::size_t Nearest(const NearQueries& query, float max_distance,
                      Span<std::uint32_t> ids, Span<float> distances,
                      const SearchOptions& options) const;
  void NearestOfEach(const NearQueries& queries, std::size_t k,
                     float max_distance, Span<std::uint32_t> ids,
                     Span<float> distances, const SearchOptions& options) const;
  void Cast(const LineCast& cast, NearFunction function, void* context,
            const SearchOptions& options) const;
  std::size_t PairsOf(const BvhPairKernels* kernels,
                      Span<const std::uint32_t> ids, Span<IdPair> pairs,
                      const PairOptions& options) const;
  void ForEachPairOf(const BvhPairKernels* kernels,
                     Span<const std::uint32_t> ids, PairsFunction function,
                     void* context, const PairOptions& options) const;
  void UpdatePairs(const BvhPairKernels* kernels, const Runner& run);
  // For the library and its tests alone.
  BroadPhaseState& state() const { return *state_; }

 private:
  BroadPhaseState* state_;
};

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_BROAD_PHASE_H_
