// Random numbers that are the same on every machine.
#ifndef HALFSPACE_BENCH_WORLDS_RANDOM_H_
#define HALFSPACE_BENCH_WORLDS_RANDOM_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>

namespace halfspace::bench {

// The engines of the standard library give the same numbers everywhere. Its
// distributions do not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  // Uniform in [-1, 1), a multiple of 2^-23.
  float Signed() {
    return static_cast<float>(engine_() >> 40) * 0x1p-23f - 1.0f;
  }
  std::size_t Below(std::size_t count) {
    return static_cast<std::size_t>(engine_() % count);
  }

 private:
  std::mt19937_64 engine_;
};

// Uniform in the ball of radius 1.
template <std::size_t kDims = 3>
std::array<float, kDims> PointInUnitSphere(Random& random) {
  for (;;) {
    std::array<float, kDims> p;
    double square = 0.0;
    for (float& coordinate : p) {
      coordinate = random.Signed();
      square += double{coordinate} * double{coordinate};
    }
    if (square <= 1.0) return p;
  }
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_RANDOM_H_
