// What the sections found out that hold the simplex's design against others:
// `volumes`, `dual` and `axes`.
#ifndef HALFSPACE_BENCH_REPORT_ALTERNATIVES_H_
#define HALFSPACE_BENCH_REPORT_ALTERNATIVES_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/measure/measure.h"

namespace halfspace::bench {

// One bounding volume, and an order of its test.
struct VolumeRow {
  std::string volume;
  std::string schedule;  // "flat", "staged", "by-axis"
  std::string target;
  std::string working_set;
  std::size_t objects = 0;
  std::size_t bytes_per_object = 0;
  double ns_per_object = 0.0;
  Ratio over_simplex;      // its time
  double looseness = 0.0;  // survivors over the AABB's
};

// The paper's scene in so many dimensions.
struct DimensionRow {
  std::size_t dimensions = 0;
  std::string target;
  std::size_t objects = 0;
  double scale = 0.0;  // of the clouds
  double simplex_ns = 0.0;
  double aabb_flat_ns = 0.0;
  double aabb_staged_ns = 0.0;
  double aabo_flat_ns = 0.0;
  double aabo_staged_ns = 0.0;
  std::size_t queries = 0;  // that survivors were counted for
  std::size_t aabb_survivors = 0;
  std::size_t simplex_survivors = 0;
  std::size_t aabo_survivors = 0;
  Ratio simplex_over_flat_aabb;
  Ratio simplex_over_fastest_aabb;
};

struct VolumesResult {
  std::string workload;
  std::size_t distinct = 0;  // objects, repeated where more are wanted
  std::vector<VolumeRow> rows;
  std::vector<DimensionRow> dimensions;
  std::vector<std::string> not_reached;
};

// An AABO's second simplex, read only where the first one leaves a survivor.
struct DualRow {
  std::string content;  // the workload's name, or "boxes of" it
  std::string working_set;
  std::string target;
  std::size_t lanes = 0;
  std::size_t objects = 0;
  // The share of batches of 1, of `lanes` and of 64 objects that need it.
  double second_of_1 = 0.0;
  double second_of_lanes = 0.0;
  double second_of_64 = 0.0;
  double simplex_ns = 0.0;
  double refined_ns = 0.0;  // the simplex, and its survivors one by one
  double flat_ns = 0.0;
  double staged_ns = 0.0;
  Ratio staged_over_flat;
  Ratio refined_over_staged;
  Ratio staged_over_simplex;
};

struct DualResult {
  std::vector<DualRow> rows;
  std::vector<std::string> not_reached;
};

// Bounding clouds of 50 points by an octahedron on some axes.
struct ConstructionRow {
  std::string axes;  // "standard", "regular, unit normals", "regular, signs"
  std::string target;
  std::size_t clouds = 0;
  std::size_t flops_per_point = 0;
  std::size_t rounded_planes = 0;  // of the octahedron's 8
  double ns_per_cloud = 0.0;
  Ratio over_standard;
  // The mean of what planes are moved outward, over the mean extent of the
  // clouds; copied planes count as 0.
  double pad_over_extent = 0.0;
};

// What is kept with one kind of axes, in one world.
struct AlignmentRow {
  std::string world;  // "balls", "boxes", "mixed", or a file
  std::size_t objects = 0;
  std::size_t queries = 0;
  std::string axes;  // "standard", "regular"
  std::size_t aabb_survivors = 0;
  std::size_t simplex_survivors = 0;
  std::size_t aabo_survivors = 0;
};

struct AxesResult {
  std::uint64_t seed = 0;
  std::vector<ConstructionRow> construction;
  std::vector<AlignmentRow> alignment;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_ALTERNATIVES_H_
