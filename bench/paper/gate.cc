// Figure 12 of the paper: a batch of w objects stops after the first half-space
// that rejects all of them. One implementation for all shapes and widths.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/target_loops.h"
#include "bench/measure/cost_model.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

std::vector<std::size_t> WidthsFrom(std::size_t lanes) {
  std::vector<std::size_t> widths;
  for (std::size_t w = std::max<std::size_t>(1, lanes); w <= kWidestGate;
       w *= 2) {
    widths.push_back(w);
  }
  return widths;
}

// All widths at which the curves cross, and who leads between them.
std::string CrossingsText(const std::vector<double>& widths,
                          const std::vector<Ratio>& box_over_simplex) {
  std::vector<double> ratios;
  ratios.reserve(box_over_simplex.size());
  for (const Ratio& ratio : box_over_simplex) ratios.push_back(ratio.median);
  const std::vector<double> crossings = CrossingsOf(widths, ratios);
  std::string leader = ratios.front() > 1.0 ? "the simplex" : "the box";
  std::string text = leader + " is faster";
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    leader = leader == "the box" ? "the simplex" : "the box";
    text += (i == 0 ? "; from w = " : "; from ") + Fixed(crossings[i], 0) +
            " on " + leader;
  }
  return text;
}

}  // namespace

Tables RunGate(Run& run) {
  WorkingSet& set = *run.Sets({"L2"}).at(0);
  Table table{"gate",
              "the paper's rule: early-out after every half-space, L2 (figure "
              "12)",
              {Key("target"), Key("w"), Value("AABB", "ns", 3),
               Value("simplex", "ns", 3), Value("AABO", "ns", 3),
               Higher("box / simplex")}};
  table.chart = Chart{"w", {"box / simplex"}, "target", true, true};
  std::vector<std::string> notes;
  std::vector<Target> targets = run.targets;
  std::reverse(targets.begin(), targets.end());
  for (Target target : targets) {
    std::vector<double> widths;
    std::vector<Ratio> ratios;
    for (std::size_t w : WidthsFrom(target.lanes())) {
      std::vector<Case> cases;
      cases.reserve(kShapes.size());
      for (ShapeKind shape : kShapes) {
        cases.push_back(set.GatedCase("gate/" + NameOf(target) + "/" +
                                          std::to_string(w) + "/" +
                                          NameOf(shape),
                                      shape, target, w));
      }
      const std::vector<Timing> ns = run.Time(cases);
      widths.push_back(static_cast<double>(w));
      ratios.push_back(RatioOf(ns[0], ns[1]));
      table.Add({NameOf(target), w, ns[0].Median(), ns[1].Median(),
                 ns[2].Median(), ratios.back()});
    }
    notes.push_back(NameOf(target) + ": " + CrossingsText(widths, ratios) +
                    ".");
  }
  notes.push_back(
      "The paper, on another machine: 2.31 and 3.28 ns at w = 1, and one "
      "crossing, at w of about 8.");
  if (run.is_page()) {
    return {Table{"gate",
                  "the paper's rule, early-out after every half-space "
                  "in batches of w (figure 12)",
                  {},
                  {},
                  notes}};
  }
  table.notes = notes;
  return {table};
}

}  // namespace halfspace::bench
