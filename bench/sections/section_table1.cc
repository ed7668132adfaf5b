#include "bench/sections/sections.h"
#include "bench/sections/survivors.h"

namespace halfspace::bench {

Table1Result RunTable1(const Workload& scene, std::uint64_t seed,
                       const Context& context) {
  Table1Result result;
  result.objects = scene.objects.size();
  result.queries = scene.queries.size();
  result.seed = seed;
  const AaboView3 view = scene.objects.view();
  WorkCounter counter(view);
  double done = 0.0;
  for (const Aabo3& query : scene.queries) {
    counter.Add(query);
    AddSurvivors(view, query, result.accepts);
    context.progress.Update(++done / static_cast<double>(result.queries));
  }
  result.work = counter.Average();
  return result;
}

}  // namespace halfspace::bench
