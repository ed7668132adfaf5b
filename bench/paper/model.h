// The quantities of sections 2.4 and 2.5 of the paper, as it defines them: pure
// arithmetic on what was counted and timed.
//
//   kappa   survivors of a query
//   c       survivors of the simplex over those of the box
//   w_cmp   ns of a compare, w_full ns of an exact test
//   E[C]    half-spaces that are evaluated per object: the sum of Pr[S_k], the
//           share of batches that reach half-space k
//   Adv(w)  ns that the simplex saves per object, with the exact tests
#ifndef HALFSPACE_BENCH_PAPER_MODEL_H_
#define HALFSPACE_BENCH_PAPER_MODEL_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "bench/measure/measure.h"

namespace halfspace::bench {

// The simplex wins in wide batches if kappa_box / objects is less than this.
inline double DensityLimit(double c, double compare_ns, double exact_ns) {
  if (c <= 1.0) return std::numeric_limits<double>::infinity();
  return 2.0 * compare_ns / ((c - 1.0) * exact_ns);
}

// What a shape costs per object.
struct ShapeCost {
  double half_spaces = 0.0;  // E[C]
  double survivors = 0.0;    // kappa / objects
};
inline double Advantage(const ShapeCost& box, const ShapeCost& simplex,
                        double compare_ns, double exact_ns) {
  return (box.half_spaces - simplex.half_spaces) * compare_ns +
         (box.survivors - simplex.survivors) * exact_ns;
}

// E[C] by the paper's formula: Pr[S_k] is 1 - p^w, where p is the share of
// objects that the half-spaces before k reject. `reached` has 1 - p of each
// half-space. The formula takes the objects of a batch for independent, and p
// for the same with all queries.
inline double HalfSpacesByFormula(std::span<const double> reached, double w) {
  double sum = 0.0;
  for (double share : reached) sum += 1.0 - std::pow(1.0 - share, w);
  return sum;
}

// ns of the exact test from which on the box wins: the simplex saves `saved` ns
// an object, and keeps `more` of all objects. Infinite if it keeps no more; 0
// if it saves nothing.
inline double BreakEven(double saved, double more) {
  if (saved <= 0.0) return 0.0;
  if (more <= 0.0) return std::numeric_limits<double>::infinity();
  return saved / more;
}

// The mean of some values, and the range that has the mean of all such values
// with a probability of 95 %: two standard errors on each side.
inline Ratio MeanOf(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (double value : values) mean += value / count;
  double square = 0.0;
  for (double value : values) square += (value - mean) * (value - mean);
  const double error =
      count > 1.0 ? std::sqrt(square / (count - 1.0) / count) : 0.0;
  return {mean, mean - 2.0 * error, mean + 2.0 * error};
}

// How often the first half-space rejects a whole batch of w objects: the
// paper's p^w. p is the share of objects that it rejects. It differs between
// queries.
struct EarlyOut {
  double of_mean_p = 0.0;  // (mean of p)^w, the paper's
  Ratio mean_of_p_w;       // mean over queries of p_q^w
  Ratio counted;           // share of batches that it rejects whole
};

// With one minimum of each object, and the query's maximum of each query.
// Objects after the last full batch are left out.
inline EarlyOut EarlyOutOf(std::span<const float> minima,
                           std::span<const float> maxima, std::size_t w) {
  const std::size_t batches = minima.size() / w;
  std::vector<float> objects(minima.begin(), minima.end());
  objects.resize(batches * w);
  std::vector<float> least;  // of each batch: it is rejected if this one is
  for (std::size_t b = 0; b < batches; ++b) {
    const auto batch = minima.subspan(b * w, w);
    least.push_back(*std::min_element(batch.begin(), batch.end()));
  }
  std::sort(objects.begin(), objects.end());
  std::sort(least.begin(), least.end());
  const auto share_above = [](const std::vector<float>& sorted, float maximum) {
    const auto first = std::upper_bound(sorted.begin(), sorted.end(), maximum);
    return static_cast<double>(sorted.end() - first) /
           static_cast<double>(sorted.size());
  };
  std::vector<double> p;
  std::vector<double> powers;
  std::vector<double> counted;
  for (float maximum : maxima) {
    p.push_back(share_above(objects, maximum));
    powers.push_back(std::pow(p.back(), static_cast<double>(w)));
    counted.push_back(share_above(least, maximum));
  }
  return {std::pow(MeanOf(p).median, static_cast<double>(w)), MeanOf(powers),
          MeanOf(counted)};
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_MODEL_H_
