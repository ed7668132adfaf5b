// The paper's model of what a batched test costs (sections 2.4 and 2.5): pure
// arithmetic.
#ifndef HALFSPACE_BENCH_MEASURE_COST_MODEL_H_
#define HALFSPACE_BENCH_MEASURE_COST_MODEL_H_

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace halfspace::bench {

// E[C]: half-spaces that a batch evaluates of `planes`, if each ends it with
// probability p: 1 + (1 - p) + (1 - p)^2 + ...
inline double ExpectedHalfSpaces(double p, std::size_t planes) {
  double sum = 0.0;
  double is_reached = 1.0;
  for (std::size_t k = 0; k < planes; ++k) {
    sum += is_reached;
    is_reached *= 1.0 - p;
  }
  return sum;
}

// From which width on one shape leads another for good.
struct LeadFrom {
  std::optional<double> w;  // empty: it does not
  bool is_at_most = false;  // it leads at the narrowest width already
};

// With the ratio of its cost to the other's at ascending widths. Between two
// widths the ratio is straight over log2 w.
inline LeadFrom FindLead(std::span<const double> widths,
                         std::span<const double> ratios) {
  std::size_t lead = ratios.size();
  while (lead > 0 && ratios[lead - 1] <= 1.0) --lead;
  if (lead == ratios.size()) return {};
  if (lead == 0) return {widths[0], true};
  const double above = ratios[lead - 1] - 1.0;
  const double below = 1.0 - ratios[lead];
  return {widths[lead - 1] * std::pow(widths[lead] / widths[lead - 1],
                                      above / (above + below)),
          false};
}

// ns of an exact test from which on the faster and looser of two ways to reject
// costs more: it saves `saved` ns an object, and keeps `more` of all objects.
// Empty if it saves nothing, or keeps no more.
inline std::optional<double> BreakEvenNanoseconds(double saved, double more) {
  if (saved <= 0.0 || more <= 0.0) return std::nullopt;
  return saved / more;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_COST_MODEL_H_
