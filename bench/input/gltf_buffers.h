// The buffers of a glTF: the chunk of a GLB, text in the JSON, or files beside
// it.
#ifndef HALFSPACE_BENCH_INPUT_GLTF_BUFFERS_H_
#define HALFSPACE_BENCH_INPUT_GLTF_BUFFERS_H_

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "bench/input/gltf_document.h"

namespace halfspace::bench {

// Reads a buffer when it is first asked for: those of images and animations
// never are.
class GltfBuffers {
 public:
  // Files take at most `most_bytes`.
  GltfBuffers(const GltfDocument& document, std::size_t most_bytes)
      : document_(document), left_(most_bytes) {}

  // The bytes of a buffer view. Throws InputError if it is not within its
  // buffer, or its buffer cannot be read.
  std::string_view ViewBytes(const GltfValue& view);

 private:
  std::string_view BytesOf(const GltfValue& buffer);
  std::string_view TextBytes(const GltfValue& buffer);
  std::string_view FileBytes(const GltfValue& buffer);
  std::size_t LargestBuffer() const;

  const GltfDocument& document_;
  std::size_t left_;
  // By place, and by path, so that two names of one file take no more than one.
  std::map<std::string, std::string> texts_;
  std::map<std::string, std::string> files_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_GLTF_BUFFERS_H_
