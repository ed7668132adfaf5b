#include "bench/sections/throughput.h"

namespace halfspace::bench {

void AddPeerParts(std::uint64_t /*seed*/, ThroughputParts& parts) {
  parts.push_back([](Throughput& throughput) {
    throughput.NotReached(
        "bar 8: built without Boost.Geometry and Bullet (libboost-dev, "
        "libbullet-dev)");
  });
}

}  // namespace halfspace::bench
