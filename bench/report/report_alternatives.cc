#include <array>
#include <cstdio>
#include <string>

#include "bench/base/text_table.h"
#include "bench/report/report.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {
namespace {

std::string Over(std::size_t survivors, std::size_t of_aabb) {
  if (of_aabb == 0) return "-";
  return Fixed(static_cast<double>(survivors) / static_cast<double>(of_aabb),
               2);
}

std::string Percent(double share) { return Fixed(100.0 * share, 2) + " %"; }

}  // namespace

void WriteText(std::ostream& out, const VolumesResult& result) {
  Heading(out, "volumes",
          "ns per object of bounding volumes at the same layout, of " +
              Printable(result.workload));
  out << "  " << Grouped(result.distinct)
      << " different objects; survivors are multiples of the aabb's\n\n";
  TextTable table({"set", "target", "volume", "schedule", "bytes", "ns/object",
                   "/ simplex [quartiles]", "survivors"});
  for (const VolumeRow& row : result.rows) {
    table.AddRow({row.working_set, row.target, row.volume, row.schedule,
                  std::to_string(row.bytes_per_object),
                  Fixed(row.ns_per_object, 4), RatioText(row.over_simplex),
                  Fixed(row.looseness, 2)});
  }
  table.Write(out, 4);
  if (!result.dimensions.empty()) {
    out << "\n  the scene in d dimensions, L2, "
        << result.dimensions.front().target
        << "; clouds are scaled so that boxes survive as often\n\n";
    TextTable dimensions({"d", "scale", "simplex", "aabb flat", "staged",
                          "aabo flat", "staged", "simplex / flat aabb",
                          "/ fastest aabb", "survivors: simplex", "aabo"});
    for (const DimensionRow& row : result.dimensions) {
      dimensions.AddRow(
          {std::to_string(row.dimensions), Fixed(row.scale, 3),
           Fixed(row.simplex_ns, 4), Fixed(row.aabb_flat_ns, 4),
           Fixed(row.aabb_staged_ns, 4), Fixed(row.aabo_flat_ns, 4),
           Fixed(row.aabo_staged_ns, 4), RatioText(row.simplex_over_flat_aabb),
           RatioText(row.simplex_over_fastest_aabb),
           Over(row.simplex_survivors, row.aabb_survivors),
           Over(row.aabo_survivors, row.aabb_survivors)});
    }
    dimensions.Write(out, 0);
  }
  WriteNotReached(out, result.not_reached);
}

void WriteText(std::ostream& out, const DualResult& result) {
  Heading(out, "dual",
          "how often an aabo's second simplex is read, and what that saves");
  TextTable table({"content", "set", "target", "of 1", "of lanes", "of 64",
                   "simplex", "refined", "flat", "staged",
                   "staged / flat [quartiles]", "refined / staged",
                   "staged / simplex"});
  for (const DualRow& row : result.rows) {
    table.AddRow({Printable(row.content), row.working_set, row.target,
                  Percent(row.second_of_1), Percent(row.second_of_lanes),
                  Percent(row.second_of_64), Fixed(row.simplex_ns, 4),
                  Fixed(row.refined_ns, 4), Fixed(row.flat_ns, 4),
                  Fixed(row.staged_ns, 4), RatioText(row.staged_over_flat),
                  RatioText(row.refined_over_staged),
                  RatioText(row.staged_over_simplex)});
  }
  table.Write(out, 3);
  WriteNotReached(out, result.not_reached);
}

void WriteText(std::ostream& out, const AxesResult& result) {
  Heading(out, "axes",
          "standard axes, with -(X + Y + Z), against a regular simplex's");
  TextTable construction({"axes", "target", "flops/point", "rounded planes",
                          "ns/cloud of 50", "/ standard [quartiles]",
                          "pad / extent"});
  for (const ConstructionRow& row : result.construction) {
    std::array<char, 32> pad{};
    std::snprintf(pad.data(), pad.size(), "%.1e", row.pad_over_extent);
    construction.AddRow(
        {row.axes, row.target, std::to_string(row.flops_per_point),
         std::to_string(row.rounded_planes), Fixed(row.ns_per_cloud, 1),
         RatioText(row.over_standard), pad.data()});
  }
  construction.Write(out, 2);
  out << "\n  survivors, as multiples of the aabb's; seed " << result.seed
      << "\n\n";
  TextTable alignment({"world", "axes", "objects", "queries", "aabb survivors",
                       "simplex", "aabo"});
  for (const AlignmentRow& row : result.alignment) {
    alignment.AddRow({Printable(row.world), row.axes, Grouped(row.objects),
                      Grouped(row.queries), Grouped(row.aabb_survivors),
                      Over(row.simplex_survivors, row.aabb_survivors),
                      Over(row.aabo_survivors, row.aabb_survivors)});
  }
  alignment.Write(out, 2);
}

}  // namespace halfspace::bench
