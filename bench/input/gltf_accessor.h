// The numbers of a glTF's accessor: where they are in the buffers, and what
// they are.
#ifndef HALFSPACE_BENCH_INPUT_GLTF_ACCESSOR_H_
#define HALFSPACE_BENCH_INPUT_GLTF_ACCESSOR_H_

#include <cstddef>
#include <string_view>
#include <vector>

#include "bench/input/gltf_buffers.h"
#include "bench/input/gltf_document.h"

namespace halfspace::bench {

enum class GltfKind { kPositions, kIndices };

// Views into the buffers, which must outlive it. All reads are within them.
class GltfAccessor {
 public:
  // Throws InputError if it is of another kind, or not within its buffers.
  GltfAccessor(const GltfDocument& document, GltfBuffers& buffers,
               GltfValue accessor, GltfKind kind);

  std::size_t count() const { return elements_.count; }

  // Three numbers for each position, one for each index; a double holds all of
  // them. Throws InputError on what is not finite, or no index.
  std::vector<double> Values() const;

 private:
  // How numbers are stored, by the format's number.
  enum class Component {
    kInt8 = 5120,
    kUint8 = 5121,
    kInt16 = 5122,
    kUint16 = 5123,
    kUint32 = 5125,
    kFloat = 5126
  };

  struct Elements {
    std::string_view bytes;
    std::size_t count = 0;
    std::size_t stride = 0;
    std::size_t components = 1;
    Component component = Component::kFloat;
    bool is_normalized = false;

    double Get(std::size_t element, std::size_t component_index) const;
  };

  static Component ComponentOf(const GltfValue& owner, GltfKind kind);
  static std::size_t BytesOf(Component component);
  static double Greatest(Component component);
  void Place(const GltfDocument& document, GltfBuffers& buffers,
             const GltfValue& owner, Elements& elements) const;
  void ReadSparse(const GltfDocument& document, GltfBuffers& buffers);
  void Check(double value, std::size_t element) const;

  GltfValue accessor_;
  GltfKind kind_;
  Elements elements_;
  Elements sparse_indices_;  // of those that the values below replace
  Elements sparse_values_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_GLTF_ACCESSOR_H_
