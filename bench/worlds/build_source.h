// Shapes in memory for one of the bulk builders, and planes for their bounds.
#ifndef HALFSPACE_BENCH_WORLDS_BUILD_SOURCE_H_
#define HALFSPACE_BENCH_WORLDS_BUILD_SOURCE_H_

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "bench/inner/target_loops.h"
#include "bench/worlds/workload.h"
#include "halfspace/fit_many.h"

namespace halfspace::bench {

enum class BuildKind { kBoxes, kSpheres, kTriangles };

inline constexpr std::array<BuildKind, 3> kBuildKinds = {
    BuildKind::kBoxes, BuildKind::kSpheres, BuildKind::kTriangles};

inline constexpr std::size_t kDAxis = 3;

struct BuildSource {
  std::string shapes;  // "boxes", "spheres", ...
  std::string planes;  // "aabo"
  std::size_t objects = 0;
  CopyJob copy;  // the bytes that a build moves

  // Bounds everything.
  std::function<Target(const FitOptions& options, FitStatus* status)> build;
  std::shared_ptr<AaboWorld3> built;  // where the bounds go

  // The bound of one object by its builder of fit.h.
  std::function<Aabo3(std::size_t object)> single;
};

// Shapes that lie where the workload's objects do, again and again if there are
// fewer: as many as make about `bytes` read and written.
BuildSource MakeBuildSource(BuildKind kind, const Workload& workload,
                            std::size_t bytes);

// Builds with these options. Empty if the bounds of some objects enclose those
// of fit.h and are equal to them in X, Y and Z; else what is wrong.
std::string CheckBuild(const BuildSource& source, const FitOptions& options);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_BUILD_SOURCE_H_
