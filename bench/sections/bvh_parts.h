// What else BVHs do than find boxes, next to others: parts of the
// section.
#ifndef HALFSPACE_BENCH_SECTIONS_BVH_PARTS_H_
#define HALFSPACE_BENCH_SECTIONS_BVH_PARTS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/sections/throughput.h"
#include "bench/worlds/box_set.h"

namespace halfspace::bench {

// One way to answer box queries.
struct BvhRow {
  std::string name;
  std::string target = {};  // empty: none of the library's
  Cell ns = {};             // a query, its queries in a row
  Cell ns_in_turns = {};    // in turns with all other rows
  // Times as fast as the fastest competitor; none without competitors.
  Cell over_fastest = {};
  Cell over_fastest_in_turns = {};
};

struct BvhResult {
  Table queries{"bvh",
                "us a query; times as fast as the fastest competitor",
                {Key("world"), Key("objects"), Key("what"), Key("target"),
                 Value("in a row", "us", 3), Higher("times"),
                 Value("in turns", "us", 3), Value("times")}};
  Table jobs{"bvh: jobs",
             "what is done to all objects at once",
             {Key("job"), Key("objects"), Value("time", "ms", 1)}};

  void AddRow(const std::string& world, std::size_t objects,
              const BvhRow& row) {
    const auto in_us = [](Cell ns) {
      if (ns.value) *ns.value /= 1e3;
      return ns;
    };
    queries.Add({world, objects, row.name, row.target, in_us(row.ns),
                 row.over_fastest, in_us(row.ns_in_turns),
                 row.over_fastest_in_turns});
  }
  void AddJob(const std::string& name, std::size_t objects,
              const Timing& timing) {
    jobs.Add({name, objects, timing.Median() / 1e6});
  }
};

// Each adds rows or jobs, and ratios: builds and memory, refits, pairs,
// searches by distance, along segments and counts.
void RunBvhBuilds(const BoxSet<3>& set, Throughput& throughput,
                  BvhResult& result);
void RunBvhRefits(const BoxSet<3>& set, Throughput& throughput,
                  BvhResult& result);
void RunBvhPairs(const BoxSet<3>& set, Throughput& throughput,
                 BvhResult& result);
void RunBvhSearches(const BoxSet<3>& set, std::uint64_t seed,
                    Throughput& throughput, BvhResult& result);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_BVH_PARTS_H_
