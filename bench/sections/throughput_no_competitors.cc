#include "bench/sections/throughput.h"

namespace halfspace::bench {

void AddCompetitorParts(std::uint64_t /*seed*/, ThroughputParts& parts) {
  parts.push_back([](Throughput& throughput) {
    throughput.NotReached(
        "built without Boost.Geometry and Bullet (libboost-dev, "
        "libbullet-dev)");
  });
}

}  // namespace halfspace::bench
