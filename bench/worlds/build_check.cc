#include "bench/worlds/build_check.h"

#include <algorithm>
#include <limits>

namespace halfspace::bench {
namespace {

constexpr std::size_t kChecked = 64;

std::string WrongBound(const Aabo3& built, const Aabo3& single) {
  if (!(built.aabb() == single.aabb())) {
    return "X, Y or Z is not that of the builder of one shape";
  }
  const bool encloses = built.min[kDAxis] <= single.min[kDAxis] &&
                        built.max[kDAxis] >= single.max[kDAxis];
  return encloses ? "" : "D does not enclose that of the builder of one shape";
}

}  // namespace

std::string CheckBuild(const BuildSource& source, const FitOptions& options) {
  // What is looked at afterwards must have been written.
  const AaboPlanes3 planes = source.built->planes();
  const std::size_t step = std::max<std::size_t>(1, source.objects / kChecked);
  const bool has_axes = source.planes == "aabo";
  for (std::size_t i = 0; i < source.objects; i += step) {
    for (std::size_t k = has_axes ? 0 : kDAxis; k <= kDAxis; ++k) {
      planes.min[k][i] = std::numeric_limits<float>::quiet_NaN();
      planes.max[k][i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const Target ran = source.build(options, nullptr);
  if (ran != options.target) return "another target ran";
  for (std::size_t i = 0; i < source.objects; i += step) {
    const std::string wrong =
        WrongBound(source.built->Get(i), source.single(i));
    if (!wrong.empty()) return "object " + std::to_string(i) + ": " + wrong;
  }
  return {};
}

}  // namespace halfspace::bench
