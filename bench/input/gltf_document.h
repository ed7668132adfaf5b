// The JSON of an untrusted glTF 2.0 file, and the chunks of a GLB. Every error
// names its place, as in "meshes[0].primitives[1].indices".
#ifndef HALFSPACE_BENCH_INPUT_GLTF_DOCUMENT_H_
#define HALFSPACE_BENCH_INPUT_GLTF_DOCUMENT_H_

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace halfspace::bench {

inline constexpr std::string_view kGlbMagic = "glTF";

// Whether a file with this content is read as glTF: a GLB, or JSON.
bool IsGltf(std::string_view content);

// A value of the JSON that knows its place. Whatever it is not fails as an
// InputError.
class GltfValue {
 public:
  GltfValue(const std::string& file, const nlohmann::json& json,
            std::string place)
      : file_(&file), json_(&json), place_(std::move(place)) {}

  const std::string& place() const { return place_; }

  // Of an object.
  bool Has(const char* key) const;
  GltfValue At(const char* key) const;

  // Of an array.
  std::size_t size() const;
  GltfValue At(std::size_t index) const;

  // Below 2^53, as which glTF may write 3 or 3.0.
  std::uint64_t Whole() const;
  std::uint64_t Whole(const char* key, std::uint64_t otherwise) const;
  double Number() const;
  bool Flag(const char* key) const;  // false if there is none
  const std::string& Text() const;

  // The problem follows the place, as in "is no whole number".
  [[noreturn]] void Fail(
      const std::string& problem,
      const std::string& advice = "export the file again") const;

 private:
  const std::string* file_;
  const nlohmann::json* json_;
  std::string place_;
};

class GltfDocument {
 public:
  // Throws InputError if it is no glTF 2.0, or needs an extension that would
  // change the triangles.
  GltfDocument(std::string path, std::string content);

  // Values are views into it.
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  const std::string& path() const { return path_; }
  GltfValue root() const { return {path_, json_, ""}; }

  // The element of an array of the root that `index` counts.
  GltfValue Refer(const GltfValue& index, const char* array) const;

  // The second chunk of a GLB; nothing if there is none.
  std::optional<std::string_view> bin() const { return bin_; }

 private:
  std::string_view ReadChunks();
  void Parse(std::string_view text);
  void CheckVersion() const;
  void CheckExtensions() const;

  std::string path_;
  std::string content_;
  nlohmann::json json_;
  std::optional<std::string_view> bin_;
  bool is_glb_ = false;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_GLTF_DOCUMENT_H_
