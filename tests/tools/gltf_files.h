// Small glTF files: a unit square of two triangles, and what tests make of it.
#ifndef HALFSPACE_TESTS_TOOLS_GLTF_FILES_H_
#define HALFSPACE_TESTS_TOOLS_GLTF_FILES_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace halfspace::bench {

using Json = nlohmann::json;

inline void AddLittleEndian(std::string& bytes, std::uint32_t value, int size) {
  for (int i = 0; i < size; ++i) {
    bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  }
}

// Each number in `size` bytes.
inline std::string Wholes(const std::vector<std::uint32_t>& values, int size) {
  std::string bytes;
  for (const std::uint32_t value : values) AddLittleEndian(bytes, value, size);
  return bytes;
}

inline std::string Floats(const std::vector<float>& values) {
  std::string bytes;
  for (const float value : values) {
    AddLittleEndian(bytes, std::bit_cast<std::uint32_t>(value), 4);
  }
  return bytes;
}

// The four corners of a square, 48 bytes, and six indices of 16 bits.
inline std::string SquareBytes() {
  return Floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
         Wholes({0, 1, 2, 0, 2, 3}, 2);
}

// One node with the square as a mesh; buffers[0] is the BIN chunk of a GLB.
inline Json Square() {
  return Json::parse(R"({
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [
      {"buffer": 0, "byteLength": 48},
      {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{"byteLength": 60}]})");
}

// Replaces what a JSON pointer, as "/nodes/0/mesh", names.
inline Json With(Json json, const std::string& pointer,
                 std::string_view value) {
  json[Json::json_pointer(pointer)] = Json::parse(value);
  return json;
}

inline std::string Chunk(std::uint32_t type, std::string content,
                         char padding) {
  while (content.size() % 4 != 0) content += padding;
  return Wholes({static_cast<std::uint32_t>(content.size()), type}, 4) +
         content;
}

inline std::string GlbOfText(const std::string& text, const std::string& bin) {
  const std::string chunks =
      Chunk(0x4E4F534A, text, ' ') + Chunk(0x004E4942, bin, '\0');
  return "glTF" +
         Wholes({2, static_cast<std::uint32_t>(chunks.size() + 12)}, 4) +
         chunks;
}

inline std::string Glb(const Json& json, const std::string& bin) {
  return GlbOfText(json.dump(), bin);
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_TESTS_TOOLS_GLTF_FILES_H_
