// Internal. The calls of broad_phase.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_BROAD_PHASE_H_
#define HALFSPACE_DETAIL_BROAD_PHASE_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace {

struct BodyMasks;
struct BroadPhaseOptions;
struct BroadPhaseStatistics;
struct UpdateOptions;

namespace detail {

// `planes` has all values of the body's bound. Returns whether to go on.
using BodyFunction = bool (*)(void* context, std::uint32_t id,
                              const float* planes);
// Returns the new limit of t; a negative one ends the search.
using BodyCastFunction = float (*)(void* context, std::uint32_t id, float t,
                                   const float* planes);
using BodyPairFunction = bool (*)(void* context, std::uint32_t a,
                                  std::uint32_t b);

// What UpdatePairs() calls.
struct PairEvents {
  void (*began)(void* context, std::uint32_t a, std::uint32_t b);
  void (*ended)(void* context, std::uint32_t a, std::uint32_t b);
  void* context;
};

class BroadPhaseState;

class HALFSPACE_API BroadPhaseCore {
 public:
  BroadPhaseCore(const BvhType& shape, std::size_t max_ids,
                 const BroadPhaseOptions& options);
  BroadPhaseCore(const BroadPhaseCore&) = delete;
  BroadPhaseCore& operator=(const BroadPhaseCore&) = delete;
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

  std::size_t max_ids() const;
  std::size_t size() const;
  bool Has(std::uint32_t id) const;
  void Get(std::uint32_t id, Span<float> values) const;
  BodyMasks MasksOf(std::uint32_t id) const;
  void Bounds(Span<float> values) const;
  bool Validate() const;
  BroadPhaseStatistics Statistics() const;

  void ForEach(const BvhQueries& query, std::uint64_t mask,
               BodyFunction function, void* context) const;
  void ForEachCast(const LineCast& cast, std::uint64_t mask,
                   BodyCastFunction function, void* context) const;
  // Without masks of the call, `masks` is null.
  void ForEachPairOf(const BvhPairKernels* kernels,
                     Span<const std::uint32_t> ids,
                     const Span<const std::uint64_t>* masks, float margin,
                     BodyPairFunction function, void* context) const;
  void UpdatePairs(const BvhPairKernels* kernels, const PairEvents& events,
                   const Runner& run);

 private:
  BroadPhaseState* state_;
};

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_BROAD_PHASE_H_
