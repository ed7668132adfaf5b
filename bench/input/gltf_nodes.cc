#include "bench/input/gltf_nodes.h"

#include <cmath>
#include <optional>
#include <utility>

namespace halfspace::bench {
namespace {

constexpr Affine kIdentity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Affine Product(const Affine& a, const Affine& b) {
  Affine product = {};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      double sum = column == 3 ? a[row][3] : 0.0;
      for (std::size_t k = 0; k < 3; ++k) sum += a[row][k] * b[k][column];
      product[row][column] = sum;
    }
  }
  return product;
}

template <std::size_t kSize>
std::array<double, kSize> Numbers(const GltfValue& list) {
  if (list.size() != kSize) {
    list.Fail("has " + std::to_string(list.size()) + " numbers, where " +
              std::to_string(kSize) + " are needed");
  }
  std::array<double, kSize> numbers;
  for (std::size_t i = 0; i < kSize; ++i) numbers[i] = list.At(i).Number();
  return numbers;
}

Affine FromMatrix(const GltfValue& value) {
  const std::array<double, 16> m = Numbers<16>(value);  // by columns
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) {
    value.Fail("has a last row other than 0 0 0 1");
  }
  Affine affine;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      affine[row][column] = m[4 * column + row];
    }
  }
  return affine;
}

// x y z w, of any length but 0: files round it.
Affine FromQuaternion(const GltfValue& value) {
  const auto [x, y, z, w] = Numbers<4>(value);
  const double length2 = x * x + y * y + z * z + w * w;
  const double s = 2 / length2;
  if (!std::isfinite(s) || s == 0) value.Fail("is no quaternion of a rotation");
  return {
      {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0},
       {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0},
       {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0}}};
}

Affine TransformOf(const GltfValue& node) {
  if (node.Has("matrix")) {
    for (const char* key : {"translation", "rotation", "scale"}) {
      if (node.Has(key)) node.At(key).Fail("is beside a matrix");
    }
    return FromMatrix(node.At("matrix"));
  }
  Affine affine = kIdentity;
  if (node.Has("rotation")) affine = FromQuaternion(node.At("rotation"));
  if (node.Has("scale")) {
    const std::array<double, 3> scale = Numbers<3>(node.At("scale"));
    for (auto& row : affine) {
      for (std::size_t k = 0; k < 3; ++k) row[k] *= scale[k];
    }
  }
  if (node.Has("translation")) {
    const std::array<double, 3> move = Numbers<3>(node.At("translation"));
    for (std::size_t k = 0; k < 3; ++k) affine[k][3] = move[k];
  }
  return affine;
}

// The scene to read; nothing if there is none.
std::optional<GltfValue> SceneOf(const GltfDocument& document) {
  const GltfValue root = document.root();
  if (root.Has("scene")) return document.Refer(root.At("scene"), "scenes");
  if (!root.Has("scenes") || root.At("scenes").size() == 0) return std::nullopt;
  return root.At("scenes").At(std::size_t{0});
}

std::vector<GltfInstance> EachMesh(const GltfDocument& document) {
  std::vector<GltfInstance> instances;
  const GltfValue root = document.root();
  const std::size_t count = root.Has("meshes") ? root.At("meshes").size() : 0;
  for (std::size_t i = 0; i < count; ++i) instances.push_back({i, kIdentity});
  return instances;
}

// Nodes are a forest: one that is met twice is in a cycle, or has two parents,
// with which a small file could stand for any number of instances.
class Walk {
 public:
  explicit Walk(const GltfDocument& document) : document_(document) {}

  void Push(const GltfValue& owner, const char* key, const Affine& to_scene) {
    if (!owner.Has(key)) return;
    const GltfValue list = owner.At(key);
    for (std::size_t i = list.size(); i-- > 0;) {
      const GltfValue index = list.At(i);
      document_.Refer(index, "nodes");
      const auto node = static_cast<std::size_t>(index.Whole());
      if (node >= is_met_.size()) is_met_.resize(node + 1);
      if (is_met_[node]) {
        index.Fail("is node " + std::to_string(node) +
                   ", which is in a cycle or has two parents");
      }
      is_met_[node] = true;
      stack_.push_back({node, to_scene});
    }
  }

  std::vector<GltfInstance> Run() {
    std::vector<GltfInstance> instances;
    while (!stack_.empty()) {
      const auto [index, to_scene] = stack_.back();
      stack_.pop_back();
      const GltfValue node = document_.root().At("nodes").At(index);
      const Affine transform = Product(to_scene, TransformOf(node));
      if (node.Has("extensions") &&
          node.At("extensions").Has("EXT_mesh_gpu_instancing")) {
        node.Fail("has EXT_mesh_gpu_instancing, which is not read",
                  "export a node for each instance");
      }
      if (node.Has("mesh")) {
        const GltfValue mesh = node.At("mesh");
        document_.Refer(mesh, "meshes");
        instances.push_back(
            {static_cast<std::size_t>(mesh.Whole()), transform});
      }
      Push(node, "children", transform);
    }
    return instances;
  }

 private:
  struct Entry {
    std::size_t node;
    Affine to_scene;
  };

  const GltfDocument& document_;
  std::vector<bool> is_met_;
  std::vector<Entry> stack_;
};

}  // namespace

std::vector<GltfInstance> MeshInstances(const GltfDocument& document) {
  const std::optional<GltfValue> scene = SceneOf(document);
  if (!scene) return EachMesh(document);
  Walk walk(document);
  walk.Push(*scene, "nodes", kIdentity);
  return walk.Run();
}

}  // namespace halfspace::bench
