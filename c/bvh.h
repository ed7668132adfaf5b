// What the functions of hierarchies share.
#ifndef HALFSPACE_C_BVH_H_
#define HALFSPACE_C_BVH_H_

#include <cstddef>
#include <memory>
#include <type_traits>

#include "c/call.h"
#include "c/columns.h"
#include "halfspace/bvh.h"
#include "halfspace/detail/bvh.h"
#include "halfspace/memory.h"

// Below the templates of bvh.h, so that there is one for all kinds.
struct hs_bvh {
  hs_bvh(const halfspace::detail::PlaneLayout& its_layout,
         const halfspace::MemoryResource& memory);
  hs_bvh(const hs_bvh&) = delete;
  hs_bvh& operator=(const hs_bvh&) = delete;
  ~hs_bvh();

  const halfspace::detail::PlaneLayout layout;
  const halfspace::c::Values objects;
  const halfspace::c::Values queries;
  halfspace::detail::BvhTree core;
  // The file that the tree is in until it changes, if it was mapped.
  halfspace::Span<const std::byte> mapped;
};

namespace halfspace::c {

template <typename Tree>
constexpr bool kIsBvh = std::is_same_v<Tree, hs_bvh>;
// The name of an argument that is a BVH or a broad phase.
template <typename Tree>
constexpr const char* kName = kIsBvh<Tree> ? "bvh" : "bodies";

detail::BvhType TypeOf(const PlaneLayout& layout);
// Fails for simplices.
const detail::BvhPairKernels* PairKernelsOf(const Call& call,
                                            const PlaneLayout& layout);

// A configuration after its checks.
struct BvhConfig {
  BvhConfig(const Call& call, const hs_bvh_config* config);

  PlaneLayout layout;
  hs_run_function run = nullptr;
  void* run_context = nullptr;
  BuildOptions options;
};

// Calls `run` of the caller's for the parts of a build.
class CallerThreads {
 public:
  CallerThreads(const Call& call, const char* argument, hs_run_function run,
                void* context)
      : call_(call), argument_(argument), run_(run), context_(context) {}

  // Empty without a function. Must not outlive this.
  Runner runner() { return run_ != nullptr ? Runner(*this) : Runner(); }

  void operator()(std::size_t count, const Runner::Part& part) const;

 private:
  Call call_;
  const char* argument_;
  hs_run_function run_;
  void* context_;
};

struct DestroyBvh {
  void operator()(hs_bvh* bvh) const { hs_bvh_destroy(bvh); }
};
using NewBvh = std::unique_ptr<hs_bvh, DestroyBvh>;
inline NewBvh MakeBvh(const PlaneLayout& layout, const MemoryResource& memory) {
  return NewBvh(New<hs_bvh>(memory, layout, memory));
}

NewBvh BuildBvh(const Call& call, const BvhConfig& config,
                const detail::Columns& objects);
NewBvh MapBvh(const Call& call, const char* path, const BvhConfig& config);
void SaveBvh(const Call& call, const char* path, const PlaneLayout& layout,
             const detail::BvhTree& tree);

}  // namespace halfspace::c

#endif  // HALFSPACE_C_BVH_H_
