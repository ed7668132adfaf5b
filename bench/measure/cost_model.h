// The quantities of sections 2.4 and 2.5 of the paper, as it defines them: pure
// arithmetic on what was counted and timed.
//
//   kappa   survivors of a query
//   c       survivors of the simplex over those of the box
//   w_cmp   ns of a compare, w_full ns of an exact test
//   E[C]    half-spaces that are evaluated per object: the sum of Pr[S_k], the
//           share of batches that reach half-space k
//   Adv(w)  ns that the simplex saves per object, with the exact tests
//   w*      the smallest w from which on it is positive
#ifndef HALFSPACE_BENCH_MEASURE_COST_MODEL_H_
#define HALFSPACE_BENCH_MEASURE_COST_MODEL_H_

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

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

// w*: from this width on, `advantage(w)` is positive up to `most`. Nothing if
// it is not positive at `most`.
template <typename AdvantageOf>
std::optional<std::size_t> WidthFrom(std::size_t most, AdvantageOf advantage) {
  std::optional<std::size_t> from;
  for (std::size_t w = most; w > 0 && advantage(static_cast<double>(w)) > 0.0;
       --w) {
    from = w;
  }
  return from;
}

// ns of the exact test from which on the box wins: the simplex saves `saved` ns
// an object, and keeps `more` of all objects. Infinite if it keeps no more; 0
// if it saves nothing.
inline double BreakEven(double saved, double more) {
  if (saved <= 0.0) return 0.0;
  if (more <= 0.0) return std::numeric_limits<double>::infinity();
  return saved / more;
}

// Where a ratio at ascending widths passes 1, between two of them straight over
// the logarithm of the width.
inline std::vector<double> CrossingsOf(std::span<const double> widths,
                                       std::span<const double> ratios) {
  std::vector<double> crossings;
  for (std::size_t i = 1; i < ratios.size(); ++i) {
    const double before = ratios[i - 1] - 1.0;
    const double after = ratios[i] - 1.0;
    if ((before > 0.0) == (after > 0.0)) continue;
    crossings.push_back(widths[i - 1] * std::pow(widths[i] / widths[i - 1],
                                                 before / (before - after)));
  }
  return crossings;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_COST_MODEL_H_
