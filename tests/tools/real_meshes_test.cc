// Known answers on real meshes, which are too large to be part of the project:
// the environment variable HALFSPACE_MESH_DIR names a folder that holds them.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include "bench/input/mesh_reader.h"
#include "bench/worlds/workload.h"
#include "halfspace/halfspace.h"

namespace halfspace::bench {
namespace {

struct KnownAnswer {
  const char* name;
  std::size_t triangles;
  std::size_t queries;
  std::size_t simplex;
  std::size_t aabb;
  std::size_t aabo;
};

void PrintTo(const KnownAnswer& known, std::ostream* out) {
  *out << known.name;
}

struct Survivors {
  std::size_t simplex = 0;
  std::size_t aabb = 0;
  std::size_t aabo = 0;
  friend bool operator==(const Survivors&, const Survivors&) = default;
};

void PrintTo(const Survivors& survivors, std::ostream* out) {
  *out << "simplex " << survivors.simplex << ", AABB " << survivors.aabb
       << ", AABO " << survivors.aabo;
}

Survivors CountAll(const AaboView3& world, const std::vector<Aabo3>& queries,
                   Target target) {
  const Options options = {.target = target};
  Survivors sum;
  for (const Aabo3& query : queries) {
    sum.simplex += CountSurvivors(world.simplex(), query.down(), options);
    sum.aabb += CountSurvivors(world.aabb(), query.aabb(), options);
    sum.aabo += CountSurvivors(world, query, options);
  }
  return sum;
}

// Outward rounding may keep a few pairs that exact arithmetic tells apart.
void ExpectAtMostOneInAThousandMore(std::size_t count, std::size_t exact) {
  EXPECT_GE(count, exact);
  EXPECT_LE(count, exact + exact / 1000);
}

class RealMesh : public testing::TestWithParam<KnownAnswer> {};

TEST_P(RealMesh, HasTheKnownSurvivors) {
  const char* folder = std::getenv("HALFSPACE_MESH_DIR");
  if (folder == nullptr) {
    GTEST_SKIP() << "set HALFSPACE_MESH_DIR to a folder that holds "
                 << GetParam().name << ".obj";
  }
  const KnownAnswer& known = GetParam();
  const Mesh mesh = ReadMesh(std::string(folder) + "/" + known.name + ".obj");
  ASSERT_EQ(mesh.triangles(), known.triangles);
  const Workload workload =
      WorkloadOfTriangles(known.name, mesh.coords, mesh.indices, /*queries=*/0);
  ASSERT_EQ(workload.queries.size(), known.queries);

  const AaboView3 world = workload.objects.view();
  const Survivors survivors = CountAll(world, workload.queries, ChosenTarget());
  EXPECT_EQ(survivors.aabb, known.aabb);
  ExpectAtMostOneInAThousandMore(survivors.simplex, known.simplex);
  ExpectAtMostOneInAThousandMore(survivors.aabo, known.aabo);
  for (const Target target : SupportedTargets()) {
    EXPECT_EQ(CountAll(world, workload.queries, target), survivors)
        << target.name();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Known, RealMesh,
    testing::Values(KnownAnswer{"stanford-bunny", 69451, 257, 4064, 3458, 3409},
                    KnownAnswer{"oasago2", 41167, 258, 18406, 6064, 5737},
                    KnownAnswer{"czest2ctf", 36808, 258, 29040, 7897, 7221}));

}  // namespace
}  // namespace halfspace::bench
