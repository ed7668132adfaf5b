// A camera flies through 100 000 objects. Each frame keeps the objects in its
// view frustum. Prints what a few frames see, and the time of an object, next
// to a loop that tests six planes.
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "halfspace/frustum.h"
#include "halfspace/reject_shapes.h"
#include "halfspace/world.h"

namespace {

using halfspace::Aabb3;
using halfspace::AabbWorld3;
using halfspace::Frustum3;
using halfspace::HalfSpace3;

constexpr std::size_t kObjects = 100'000;
constexpr int kFrames = 200;

// The product of a projection with 0 <= z <= w and of a camera that looks along
// its circle around the middle of the world. Stored by columns.
std::array<float, 16> CameraAt(float time) {
  const float yaw = 6.28f * time;
  const std::array<float, 3> forward = {std::cos(yaw), 0, std::sin(yaw)};
  const std::array<float, 3> right = {-std::sin(yaw), 0, std::cos(yaw)};
  const std::array<float, 3> up = {0, 1, 0};
  const std::array<float, 3> eye = {500 + 300 * std::sin(yaw), 500,
                                    500 - 300 * std::cos(yaw)};
  const float near = 0.1f;
  const float far = 400;
  const float focal = 1.732f;  // 60 degrees
  std::array<float, 16> matrix{};
  const auto set_row = [&](std::size_t row, const std::array<float, 3>& axis,
                           float factor, float last) {
    matrix[12 + row] = last;
    for (std::size_t k = 0; k < 3; ++k) {
      matrix[4 * k + row] = factor * axis[k];
      matrix[12 + row] -= factor * axis[k] * eye[k];
    }
  };
  set_row(0, right, focal * 9 / 16, 0);
  set_row(1, up, focal, 0);
  set_row(2, forward, far / (far - near), -far * near / (far - near));
  set_row(3, forward, 1, 0);
  return matrix;
}

// What programs without SIMD do: an object is kept unless its foremost corner
// is behind one of the six planes.
std::size_t PlainCount(const AabbWorld3& world, const Frustum3& seen) {
  const auto view = world.view();
  std::size_t count = 0;
  for (std::size_t i = 0; i < view.size; ++i) {
    bool is_in = true;
    for (std::size_t f = 0; is_in && f < 6; ++f) {
      float sum = seen[f].offset;
      for (std::size_t k = 0; k < 3; ++k) {
        const float normal = seen[f].normal[k];
        sum += normal * (normal > 0 ? view.max[k][i] : view.min[k][i]);
      }
      is_in = sum >= 0;
    }
    count += is_in ? 1 : 0;
  }
  return count;
}

}  // namespace

int main() {
  AabbWorld3 world;
  std::uint32_t state = 1;
  const auto random = [&state] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) * 0x1p-24f;
  };
  for (std::size_t i = 0; i < kObjects; ++i) {
    Aabb3 box;
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = 1000 * random();
      const float half = 5 * random();
      box.min[k] = center - half;
      box.max[k] = center + half;
    }
    world.Push(box);
  }

  using Clock = std::chrono::steady_clock;
  Clock::duration ours{};
  Clock::duration plain{};
  std::vector<std::uint32_t> visible(world.size());
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto matrix = CameraAt(static_cast<float>(frame) / kFrames);
    const auto begin = Clock::now();
    const Frustum3 seen = halfspace::FrustumPlanes(
        matrix.data(), halfspace::ClipDepth::kZeroToOne);
    const std::size_t count = halfspace::Survivors(world, seen, visible);
    const auto middle = Clock::now();
    const std::size_t of_plain = PlainCount(world, seen);
    plain += Clock::now() - middle;
    ours += middle - begin;
    // The box around the frustum rejects a few objects more. And the plain loop
    // may lose one that just touches.
    if (count > of_plain + 10 || 2 * count < of_plain) return 1;
    if (frame % 40 == 0) {
      std::printf("frame %3d: %zu visible, %zu by six planes\n", frame, count,
                  of_plain);
    }
  }
  const auto per_object = [](Clock::duration time) {
    return std::chrono::duration<double, std::nano>(time).count() /
           (kFrames * static_cast<double>(kObjects));
  };
  std::printf("%.2f ns an object, %.2f in a plain loop\n", per_object(ours),
              per_object(plain));
  return 0;
}
