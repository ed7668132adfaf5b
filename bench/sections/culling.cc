// Culling by view frusta: half-spaces of the library beside loops by hand and
// loops that the compiler vectorises.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/cull_loops.h"
#include "bench/sections/contest.h"
#include "bench/worlds/random.h"
#include "bench/worlds/working_set.h"
#include "halfspace/fit.h"
#include "halfspace/frustum.h"
#include "halfspace/reject_shapes.h"

namespace halfspace::bench {
namespace {

constexpr float kSide = 1000;  // of the world
constexpr std::size_t kCameras = 20'009;

double Unit(Random& random) { return 0.5 * random.Signed() + 0.5; }

// Cameras with 60 degrees of view, up to 800 away.
std::vector<Frustum3> Cameras(Random& random) {
  std::vector<Frustum3> frusta(kCameras);
  for (Frustum3& frustum : frusta) {
    const double yaw = 6.3 * Unit(random);
    const double pitch = Unit(random) - 0.5;
    const std::array<double, 3> forward = {std::cos(yaw) * std::cos(pitch),
                                           std::sin(pitch),
                                           std::sin(yaw) * std::cos(pitch)};
    const std::array<double, 3> right = {-std::sin(yaw), 0, std::cos(yaw)};
    std::array<double, 3> up;
    std::array<double, 3> eye;
    for (std::size_t k = 0; k < 3; ++k) {
      up[k] = right[(k + 1) % 3] * forward[(k + 2) % 3] -
              right[(k + 2) % 3] * forward[(k + 1) % 3];
      eye[k] = kSide * Unit(random);
    }
    const double near = 0.1;
    const double far = 800;
    std::array<float, 16> matrix{};
    const auto set_row = [&](std::size_t row, const auto& axis, double factor,
                             double last) {
      double offset = last;
      for (std::size_t k = 0; k < 3; ++k) {
        matrix[4 * row + k] = static_cast<float>(factor * axis[k]);
        offset -= factor * axis[k] * eye[k];
      }
      matrix[4 * row + 3] = static_cast<float>(offset);
    };
    set_row(0, right, 1.732 * 9 / 16, 0);
    set_row(1, up, 1.732, 0);
    set_row(2, forward, far / (far - near), -far * near / (far - near));
    set_row(3, forward, 1, 0);
    frustum = FrustumPlanes(matrix.data(), ClipDepth::kZeroToOne,
                            MatrixOrder::kRowMajor);
  }
  return frusta;
}

std::span<const HalfSpace3> SixOf(const Frustum3& frustum) {
  return std::span(frustum).first(6);
}

// Boxes with the spheres around them, and all that loops read.
struct CullScene {
  CullScene(std::size_t objects, bool is_sorted, Random& random) {
    std::vector<std::array<float, 6>> made(objects);
    for (auto& object : made) {
      for (std::size_t k = 0; k < 3; ++k) {
        object[k] = kSide * static_cast<float>(Unit(random));
        object[3 + k] = 5 * static_cast<float>(Unit(random));
      }
    }
    if (is_sorted) {
      std::vector<std::pair<std::uint64_t, std::size_t>> order(objects);
      for (std::size_t i = 0; i < objects; ++i) {
        std::uint64_t key = 0;
        for (int bit = 9; bit >= 0; --bit) {
          for (std::size_t k = 0; k < 3; ++k) {
            const auto cell = static_cast<std::uint32_t>(made[i][k] * 1.023f);
            key = key << 1 | (cell >> bit & 1);
          }
        }
        order[i] = {key, i};
      }
      std::sort(order.begin(), order.end());
      auto sorted = made;
      for (std::size_t i = 0; i < objects; ++i) {
        sorted[i] = made[order[i].second];
      }
      made = std::move(sorted);
    }
    boxes.Resize(objects);
    for (auto& plane : centers) plane.resize(objects);
    radii.resize(objects);
    for (std::size_t i = 0; i < objects; ++i) {
      Aabb3 box;
      float squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        box.min[k] = made[i][k] - made[i][3 + k];
        box.max[k] = made[i][k] + made[i][3 + k];
        centers[k][i] = made[i][k];
        centers[3 + k][i] = made[i][3 + k];
        squared += made[i][3 + k] * made[i][3 + k];
      }
      boxes.Set(i, box);
      radii[i] = std::sqrt(squared);
    }
    octahedra.Resize(objects);
    for (std::size_t i = 0; i < objects; ++i) {
      octahedra.Set(i, BoundAabb(boxes.Get(i)));
    }
    kept.resize(MaskWords(objects));
    bytes.resize(objects / 8);
  }

  SphereView3 spheres() const {
    SphereView3 view;
    for (std::size_t k = 0; k < 3; ++k) view.center[k] = centers[k].data();
    view.radius = radii.data();
    view.size = radii.size();
    return view;
  }
  std::vector<const float*> PlanesOf(CullInput input) const {
    if (input == CullInput::kCorners) {
      const AabbView3 view = boxes.view();
      return {view.min[0], view.min[1], view.min[2],
              view.max[0], view.max[1], view.max[2]};
    }
    std::vector<const float*> planes;
    for (const auto& plane : centers) planes.push_back(plane.data());
    if (input == CullInput::kSpheres) planes[3] = radii.data();
    return planes;
  }

  AabbWorld3 boxes;
  AaboWorld3 octahedra;
  std::array<std::vector<float>, 6> centers;  // and half sizes
  std::vector<float> radii;
  std::vector<std::uint64_t> kept;
  std::vector<std::uint64_t> bytes;
};

void AddCullRows(Run& run, CullScene& scene, const char* order,
                 const std::vector<Frustum3>& cameras, Target target,
                 const std::string& bound, Table& table) {
  Contest contest(run, "culling");
  std::vector<double> share;
  const std::size_t objects = scene.boxes.size();
  const auto on_world = [&](const auto& call) {
    if (bound == "AABB") return call(scene.boxes);
    if (bound == "AABO") return call(scene.octahedra);
    return call(scene.spheres());
  };
  const auto right_count = [&](std::size_t q) {
    return on_world([&](const auto& world) {
      return CountSurvivors(world, SixOf(cameras[q]), {.target = target});
    });
  };
  constexpr std::size_t kChecked = 50;
  // By six half-spaces each contestant keeps the same objects, up to rounding,
  // and with a box around them fewer.
  const auto add = [&](const char* by, Who who, bool has_box, auto call,
                       auto count) {
    std::size_t right = 0;
    std::size_t found = 0;
    for (std::size_t q = 0; q < kChecked; ++q) {
      right += right_count(q);
      call(q);
      found += count();
    }
    share.push_back(static_cast<double>(found) /
                    static_cast<double>(kChecked * objects));
    Case c = CaseOfQueries(kCameras, objects, call);
    c.items *= static_cast<double>(objects);
    const std::size_t slack = right / 10'000 + 2;
    const bool is_right = found <= right + slack &&
                          found + (has_box ? right / 2 : slack) >= right;
    c.check = [is_right] {
      return std::string(is_right ? "" : "other objects are kept");
    };
    contest.Add({bound, order, NameOf(target), objects, by}, std::move(c), who);
  };
  for (const CullLoop& loop : CullLoopsOf(target.name())) {
    if ((loop.input == CullInput::kSpheres) != (bound == "sphere")) continue;
    const auto planes = scene.PlanesOf(loop.input);
    auto& output = loop.writes_bytes ? scene.bytes : scene.kept;
    add(
        loop.name, Who::kCompetitor, false,
        [&cameras, loop, planes, objects, &output](std::size_t q) {
          loop.run(planes.data(), objects, cameras[q].data(), output.data());
        },
        [&output] { return CountBits(output); });
  }
  const auto add_ours = [&](const char* by, bool has_box, auto list_of) {
    on_world([&](const auto& world) {
      add(
          by, Who::kOurs, has_box,
          [&cameras, &scene, world = world.view(), list_of,
           target](std::size_t q) {
            SurvivorMask(world, list_of(cameras[q]), scene.kept,
                         {.target = target});
          },
          [&scene] { return CountBits(scene.kept); });
      return std::size_t{0};
    });
  };
  add_ours("6 half-spaces", false, &SixOf);
  add_ours("FrustumPlanes()", true,
           [](const Frustum3& frustum) -> const Frustum3& { return frustum; });
  contest.Time();
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {SpreadOf(contest.timing(i)),
            RatioOf(contest.timing(i), contest.fastest()), 100.0 * share[i]};
  });
}

}  // namespace

Tables RunCulling(Run& run) {
  Table table{"culling",
              "objects in a camera's frustum",
              {Key("bound"), Key("order"), Key("target"), Key("objects"),
               Key("by"), Lower("ns/object", "", 3),
               Value("over the best loop"), Value("kept", "%", 1)}};
  Random random(run.options.seed);
  const std::vector<Frustum3> cameras = Cameras(random);
  // As loops by hand need, a multiple of 64.
  std::vector<std::size_t> sizes = {1024, 16'384, 99'968};
  if (!run.options.is_quick) sizes.push_back(999'936);
  for (std::size_t objects : sizes) {
    for (const char* order : {"random", "Morton"}) {
      CullScene scene(objects, order[0] == 'M', random);
      for (const char* bound : {"AABB", "AABO", "sphere"}) {
        for (Target target : run.targets) {
          if (objects > 100'000 && target != run.best()) continue;
          AddCullRows(run, scene, order, cameras, target, bound, table);
        }
      }
    }
  }
  table.notes = {
      "FrustumPlanes() has the box around the frustum, too, and keeps fewer. "
      "Loops for octahedra are those for boxes. Loops do not round outward, "
      "and "
      "plain ones write a byte for each object."};
  return {table};
}

}  // namespace halfspace::bench
