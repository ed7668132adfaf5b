// Pairs of hs_bvh and hs_broad_phase.
#include <cstddef>
#include <cstdint>
#include <limits>

#include "c/broad_phase.h"
#include "c/bvh.h"
#include "c/call.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::c {
namespace {

constexpr hs_pair_options kPairDefaults = {
    sizeof(hs_pair_options),
    0xFFFFFFFF,
    0.0f,
    0,
    0,
    std::numeric_limits<std::size_t>::max(),
    nullptr,
    nullptr,
    0.0f};

static_assert(sizeof(hs_id_pair) == sizeof(IdPair));
static_assert(alignof(hs_id_pair) == alignof(IdPair));
static_assert(offsetof(hs_id_pair, b) == offsetof(IdPair, b));

// The pairs that a call searches.
template <typename Tree>
struct Sources {
  const Tree* a;
  const hs_bvh* b = nullptr;
  const std::uint32_t* ids = nullptr;  // of a set of `count` objects of a
  std::size_t count = 0;
  bool is_of_set = false;
  bool is_join = false;  // of a and b

  void Check(const Call& call) const {
    call.CheckPointer(is_join ? "a" : kName<Tree>, a);
    if (is_join) call.CheckPointer("b", b);
  }
};

// Calls run(options, set, kernels).
template <typename Tree, typename Function>
void RunPairs(const Call& call, const Sources<Tree>& from,
              const hs_pair_options* options, const Function& run) {
  const hs_pair_options read =
      ReadOptions(call, "options", options, kPairDefaults);
  PairOptions pairs = {.mask = read.mask,
                       .margin = read.margin,
                       .within = read.within,
                       .skip = read.skip,
                       .begin = read.begin,
                       .end = read.end,
                       .target = ReadTarget(call, "options", read.target)};
  if (read.wanted != nullptr && from.is_of_set) {
    pairs.wanted = {read.wanted, from.count};
  }
  if (from.is_of_set) call.CheckArray("ids", from.ids, from.count);
  const Span<const std::uint32_t> set(from.ids, from.count);
  const detail::PlaneLayout& layout = from.a->layout;
  const detail::BvhPairKernels* const kernels = PairKernelsOf(call, layout);
  if (from.b != nullptr && from.b->layout != layout) {
    call.Fail(HS_INVALID_ARGUMENT, "b",
              "expected a BVH of the kind of `a`, got another kind");
  }
  run(pairs, set, kernels);
}

template <typename Tree>
hs_status WritePairs(const char* name, const Sources<Tree>& from,
                     const hs_pair_options* options, hs_id_pair* pairs,
                     std::size_t room, std::size_t* total) {
  return Run(name, [&](const Call& call) {
    from.Check(call);
    call.CheckArray("pairs", pairs, room);
    call.CheckPointer("total", total);
    const Span<IdPair> to(reinterpret_cast<IdPair*>(pairs), room);
    RunPairs(call, from, options,
             [&](const PairOptions& read, const Span<const std::uint32_t>& set,
                 const detail::BvhPairKernels* kernels) {
               if constexpr (kIsBvh<Tree>) {
                 *total = detail::BvhPairs(
                     {kernels, &from.a->core,
                      from.b == nullptr ? nullptr : &from.b->core,
                      from.is_of_set ? &set : nullptr},
                     to, read);
               } else {
                 *total = from.a->core.PairsOf(kernels, set, to, read);
               }
             });
  });
}

template <typename Tree>
hs_status CallForPairs(const char* name, const Sources<Tree>& from,
                       const hs_pair_options* options,
                       hs_pairs_function function, void* context) {
  return Run(name, [&](const Call& call) {
    from.Check(call);
    call.CheckPointer("function", function);
    detail::Callback some{[&](Span<const IdPair> pairs) {
      return function(context,
                      reinterpret_cast<const hs_id_pair*>(pairs.data()),
                      pairs.size()) == HS_CONTINUE;
    }};
    RunPairs(call, from, options,
             [&](const PairOptions& read, const Span<const std::uint32_t>& set,
                 const detail::BvhPairKernels* kernels) {
               if constexpr (kIsBvh<Tree>) {
                 detail::BvhForEachPair(
                     {kernels, &from.a->core,
                      from.b == nullptr ? nullptr : &from.b->core,
                      from.is_of_set ? &set : nullptr},
                     &decltype(some)::Run, &some, read);
               } else {
                 from.a->core.ForEachPairOf(kernels, set, &decltype(some)::Run,
                                            &some, read);
               }
             });
  });
}

}  // namespace

const detail::BvhPairKernels* PairKernelsOf(const Call& call,
                                            const PlaneLayout& layout) {
  if (layout.kind == PlaneLayout::kSimplex) {
    call.Fail(HS_INVALID_ARGUMENT, "",
              "expected BVHs of boxes or octahedra, got simplices, which have "
              "no planes that face each other");
  }
  if (layout.axes == 2) return detail::BvhPairKernelsOf<2>::kTargets;
  if (layout.axes == 3) return detail::BvhPairKernelsOf<3>::kTargets;
  return detail::BvhPairKernelsOf<4>::kTargets;
}

}  // namespace halfspace::c

using halfspace::c::CallForPairs;
using halfspace::c::Get;
using halfspace::c::WritePairs;

HALFSPACE_DEFAULTS_OF(hs_pair_options, kPairDefaults)

// The searches that BVHs and broad phases have in common.
#define HALFSPACE_PAIRS_OF(Type)                                               \
  hs_status Type##_pairs_of(const Type* in, const uint32_t* ids, size_t count, \
                            const hs_pair_options* options, hs_id_pair* pairs, \
                            size_t room, size_t* total) {                      \
    return WritePairs<Type>(                                                   \
        #Type "_pairs_of",                                                     \
        {.a = in, .ids = ids, .count = count, .is_of_set = true}, options,     \
        pairs, room, total);                                                   \
  }                                                                            \
  hs_status Type##_pairs_of_each(const Type* in, const uint32_t* ids,          \
                                 size_t count, const hs_pair_options* options, \
                                 hs_pairs_function function, void* context) {  \
    return CallForPairs<Type>(                                                 \
        #Type "_pairs_of_each",                                                \
        {.a = in, .ids = ids, .count = count, .is_of_set = true}, options,     \
        function, context);                                                    \
  }

HALFSPACE_PAIRS_OF(hs_bvh)
HALFSPACE_PAIRS_OF(hs_broad_phase)
#undef HALFSPACE_PAIRS_OF

hs_status hs_bvh_pairs(const hs_bvh* bvh, const hs_pair_options* options,
                       hs_id_pair* pairs, size_t room, size_t* total) {
  return WritePairs<hs_bvh>("hs_bvh_pairs", {.a = bvh}, options, pairs, room,
                            total);
}

hs_status hs_bvh_join(const hs_bvh* a, const hs_bvh* b,
                      const hs_pair_options* options, hs_id_pair* pairs,
                      size_t room, size_t* total) {
  return WritePairs<hs_bvh>("hs_bvh_join", {.a = a, .b = b, .is_join = true},
                            options, pairs, room, total);
}

hs_status hs_bvh_pairs_each(const hs_bvh* bvh, const hs_pair_options* options,
                            hs_pairs_function function, void* context) {
  return CallForPairs<hs_bvh>("hs_bvh_pairs_each", {.a = bvh}, options,
                              function, context);
}

hs_status hs_bvh_join_each(const hs_bvh* a, const hs_bvh* b,
                           const hs_pair_options* options,
                           hs_pairs_function function, void* context) {
  return CallForPairs<hs_bvh>("hs_bvh_join_each",
                              {.a = a, .b = b, .is_join = true}, options,
                              function, context);
}

hs_status hs_bvh_pair_parts(const hs_bvh* bvh, size_t* parts) {
  return Get("hs_bvh_pair_parts", "bvh", bvh, "parts", parts,
             [&] { return (bvh->core.ids().size() + 63) / 64; });
}
