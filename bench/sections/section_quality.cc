#include "bench/sections/sections.h"
#include "bench/sections/survivors.h"

namespace halfspace::bench {

QualityResult RunQuality(const Workload& workload, const Context& context) {
  QualityResult result;
  result.workload = workload.name;
  result.objects = workload.objects.size();
  result.queries = workload.queries.size();
  const AaboView3 view = workload.objects.view();
  double done = 0.0;
  for (const Aabo3& query : workload.queries) {
    AddSurvivors(view, query, result.survivors);
    context.progress.Update(++done / static_cast<double>(result.queries));
  }
  return result;
}

}  // namespace halfspace::bench
