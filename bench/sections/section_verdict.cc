#include <optional>
#include <string>

#include "bench/base/text_table.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// A shape's fastest schedule in one working set.
struct Best {
  double ns = 0.0;
  std::string schedule;
};

std::optional<Best> BestOf(const KernelsResult& kernels, const char* shape,
                           const std::string& target,
                           const std::string& working_set) {
  std::optional<Best> best;
  for (const KernelRow& row : kernels.rows) {
    if (row.shape != shape || row.target != target ||
        row.working_set != working_set) {
      continue;
    }
    if (!best || row.ns_per_object < best->ns) {
      best = Best{row.ns_per_object, row.schedule};
    }
  }
  return best;
}

struct BestShapes {
  Best aabb;
  Best simplex;
  Best aabo;
};

std::optional<BestShapes> BestShapesOf(const KernelsResult& kernels,
                                       const std::string& target,
                                       const std::string& working_set) {
  const auto aabb = BestOf(kernels, "aabb", target, working_set);
  const auto simplex = BestOf(kernels, "simplex", target, working_set);
  const auto aabo = BestOf(kernels, "aabo", target, working_set);
  if (!aabb || !simplex || !aabo) return std::nullopt;
  return BestShapes{*aabb, *simplex, *aabo};
}

// Differences below this are noise on a shared machine.
constexpr double kTie = 0.03;

std::string SpeedIn(const std::string& working_set, const BestShapes& best) {
  const double ratio = best.simplex.ns / best.aabb.ns;
  std::string text = "in " + working_set + " ";
  if (ratio < 1.0 - kTie) {
    text += "the simplex is " + Fixed(1.0 / ratio, 2) + " times as fast as ";
  } else if (ratio > 1.0 + kTie) {
    text += "the box wins: the simplex is only " + Fixed(1.0 / ratio, 2) +
            " times as fast as ";
  } else {
    text += "the simplex is as fast as ";
  }
  return text + "the AABB (" + Fixed(best.simplex.ns, 3) + " against " +
         Fixed(best.aabb.ns, 3) + " ns an object, the AABB " +
         best.aabb.schedule + "), and the AABO takes " +
         Fixed(best.aabo.ns, 3) + " (" + best.aabo.schedule + ")";
}

std::string SpeedSentence(const Results& results, const std::string& target) {
  if (!results.kernels) {
    return "Speed was not measured: run the section kernels too.";
  }
  std::string text;
  for (const char* set : {"L2", "memory"}) {
    const auto best = BestShapesOf(*results.kernels, target, set);
    if (!best) continue;
    text +=
        (text.empty() ? "With " + target + ", " : "; ") + SpeedIn(set, *best);
  }
  return text.empty() ? "Speed was not measured for " + target + "."
                      : text + ".";
}

std::string CrossoverSentence(const Results& results,
                              const std::string& target) {
  if (!results.crossover) {
    return "The crossover was not measured: run the section crossover too.";
  }
  for (const WStar& star : results.crossover->w_stars) {
    if (star.target != target || star.working_set != "L2") continue;
    const std::string gate =
        "With an early-out after every half-space, as in the paper, ";
    if (!star.w_star) {
      return gate +
             "the simplex does not stay ahead of the box up to batches "
             "of 4096 objects (" +
             target + ", L2): there is no crossover.";
    }
    return gate + "the simplex beats the box from batches of " +
           (star.is_at_most ? "at most " : "about ") + Fixed(*star.w_star, 0) +
           " objects (" + target + ", L2).";
  }
  return "The crossover was not measured for " + target + ".";
}

std::string Times(std::size_t survivors, std::size_t of_aabb) {
  return Fixed(static_cast<double>(survivors) / static_cast<double>(of_aabb),
               2);
}

// What the simplex is weighed against: the tighter AABO where it costs no more
// than the AABB.
struct Alternative {
  std::string name;
  double ns = 0.0;
  std::size_t survivors = 0;
};

Alternative AlternativeOf(const QualityResult& quality,
                          const BestShapes& best) {
  if (best.aabo.ns <= best.aabb.ns * (1.0 + kTie)) {
    return {"AABO", best.aabo.ns, quality.survivors.aabo};
  }
  return {"AABB", best.aabb.ns, quality.survivors.aabb};
}

// What a needless survivor may cost before the faster test no longer pays.
std::optional<double> BreakEvenNanoseconds(const QualityResult& quality,
                                           const BestShapes& best,
                                           const Alternative& alternative) {
  const double saved_per_object = alternative.ns - best.simplex.ns;
  const double tests = static_cast<double>(quality.objects) *
                       static_cast<double>(quality.queries);
  const double more = static_cast<double>(quality.survivors.simplex) -
                      static_cast<double>(alternative.survivors);
  if (saved_per_object <= 0.0 || more <= 0.0) return std::nullopt;
  return saved_per_object * tests / more;
}

std::string AdviceFor(const QualityResult& quality, const BestShapes& best) {
  const Alternative alternative = AlternativeOf(quality, best);
  if (best.simplex.ns < alternative.ns &&
      quality.survivors.simplex <= alternative.survivors) {
    return ", and is faster in L2: use the simplex.";
  }
  const auto limit = BreakEvenNanoseconds(quality, best, alternative);
  const std::string use =
      alternative.name == "AABO"
          ? "use the AABO, which costs no more than the AABB and is tighter"
          : "use the AABB, or the AABO where survivors are dear";
  if (!limit) return ", and saves no time in L2: " + use + ".";
  return ": in L2 the simplex pays while each needless survivor costs less "
         "than " +
         Fixed(*limit, 0) + " ns; beyond that " + use + ".";
}

std::string QualitySentence(const Results& results, const std::string& target) {
  if (!results.quality) {
    return "Survivors were not counted: run the section quality too.";
  }
  const QualityResult& quality = *results.quality;
  const std::string what =
      quality.workload == "scene" ? "the scene" : Printable(quality.workload);
  if (quality.survivors.aabb == 0) {
    return "No object of " + what +
           " survives an AABB test, so looseness is undefined.";
  }
  const std::string text =
      "Of " + what + " the simplex keeps " +
      Times(quality.survivors.simplex, quality.survivors.aabb) +
      " and the AABO " + Times(quality.survivors.aabo, quality.survivors.aabb) +
      " times as many objects as the AABB";
  const auto best = results.kernels
                        ? BestShapesOf(*results.kernels, target, "L2")
                        : std::nullopt;
  return text + (best ? AdviceFor(quality, *best) : ".");
}

}  // namespace

VerdictResult MakeVerdict(const Results& results, Target target) {
  const std::string name(target.name());
  return {{SpeedSentence(results, name), CrossoverSentence(results, name),
           QualitySentence(results, name)}};
}

}  // namespace halfspace::bench
