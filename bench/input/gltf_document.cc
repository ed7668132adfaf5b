#include "bench/input/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bench/input/input_error.h"
#include "bench/input/little_endian.h"
#include "bench/input/text_lines.h"

namespace halfspace::bench {
namespace {

using Json = nlohmann::json;

constexpr const char* kTruncated = "copy it again, it may be truncated";
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;

// What may be required and does not change where triangles are: how they look,
// and positions in 8 or 16 bits, which are read.
constexpr std::array<std::string_view, 7> kHarmless = {
    "KHR_materials_", "KHR_texture_", "KHR_lights_",          "EXT_texture_",
    "EXT_lights_",    "MSFT_texture", "KHR_mesh_quantization"};

}  // namespace

bool IsGltf(std::string_view content) {
  if (content.starts_with(kGlbMagic)) return true;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (content.starts_with(kByteOrderMark)) {
    content.remove_prefix(kByteOrderMark.size());
  }
  const std::size_t first = content.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && content[first] == '{';
}

bool GltfValue::Has(const char* key) const {
  if (!json_->is_object()) Fail("is no JSON object");
  return json_->contains(key);
}

GltfValue GltfValue::At(const char* key) const {
  GltfValue value = *this;
  if (!place_.empty()) value.place_ += '.';
  value.place_ += key;
  if (!Has(key)) value.Fail("is missing");
  value.json_ = &(*json_)[key];
  return value;
}

std::size_t GltfValue::size() const {
  if (!json_->is_array()) Fail("is no JSON array");
  return json_->size();
}

GltfValue GltfValue::At(std::size_t index) const {
  return {*file_, json_->at(index), place_ + "[" + std::to_string(index) + "]"};
}

std::uint64_t GltfValue::Whole() const {
  constexpr double kLimit = 0x1p53;
  const double value = json_->is_number() ? json_->get<double>() : -1.0;
  if (value < 0 || value != std::floor(value)) Fail("is no whole number");
  if (value >= kLimit) Fail("is too large a number");
  return static_cast<std::uint64_t>(value);
}

std::uint64_t GltfValue::Whole(const char* key, std::uint64_t otherwise) const {
  return Has(key) ? At(key).Whole() : otherwise;
}

double GltfValue::Number() const {
  if (!json_->is_number()) Fail("is no number");
  return json_->get<double>();
}

bool GltfValue::Flag(const char* key) const {
  if (!Has(key)) return false;
  const GltfValue value = At(key);
  if (!value.json_->is_boolean()) value.Fail("is neither true nor false");
  return value.json_->get<bool>();
}

const std::string& GltfValue::Text() const {
  if (!json_->is_string()) Fail("is no JSON string");
  return json_->get_ref<const std::string&>();
}

void GltfValue::Fail(const std::string& problem,
                     const std::string& advice) const {
  throw InputError(
      *file_, (place_.empty() ? "the file" : place_) + " " + problem, advice);
}

GltfDocument::GltfDocument(std::string path, std::string content)
    : path_(std::move(path)), content_(std::move(content)) {
  is_glb_ = content_.starts_with(kGlbMagic);
  Parse(is_glb_ ? ReadChunks() : std::string_view(content_));
  CheckVersion();
  CheckExtensions();
}

// The text of the first chunk.
std::string_view GltfDocument::ReadChunks() {
  std::string_view rest = content_;
  const auto take = [&](std::size_t bytes) {
    const std::string_view taken = rest.substr(0, bytes);
    if (taken.size() < bytes) {
      throw InputError(path_,
                       "the GLB ends after " + std::to_string(content_.size()) +
                           " bytes, within a header or a chunk",
                       kTruncated);
    }
    rest.remove_prefix(bytes);
    return taken;
  };
  const std::string_view header = take(kHeaderBytes);
  const std::uint32_t version = LittleEndian(header.substr(4, 4));
  if (version != 2) {
    throw InputError(path_, "a GLB of version " + std::to_string(version),
                     "convert it to version 2");
  }
  const std::uint32_t length = LittleEndian(header.substr(8, 4));
  if (length != content_.size()) {
    throw InputError(path_,
                     "the header of the GLB says " + std::to_string(length) +
                         " bytes, and the file has " +
                         std::to_string(content_.size()),
                     kTruncated);
  }
  std::optional<std::string_view> text;
  for (std::size_t i = 0; !rest.empty(); ++i) {
    const std::string_view chunk_header = take(kChunkHeaderBytes);
    const std::uint32_t type = LittleEndian(chunk_header.substr(4));
    const std::string_view chunk =
        take(LittleEndian(chunk_header.substr(0, 4)));
    if (i == 0 && type == kJsonChunk) text = chunk;
    if (i == 1 && type == kBinChunk) bin_ = chunk;
  }
  if (!text) {
    throw InputError(path_, "the first chunk of the GLB is not its JSON",
                     "export the file again");
  }
  return *text;
}

void GltfDocument::Parse(std::string_view text) {
  try {
    json_ = Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::string_view good = text.substr(0, error.byte);
    const auto line_ends = std::count(good.begin(), good.end(), '\n');
    const std::size_t line = static_cast<std::size_t>(line_ends) + 1;
    const std::string advice = "export the file again, it may be truncated";
    if (!is_glb_) throw InputError(path_, line, "malformed JSON", advice);
    throw InputError(
        path_, "malformed JSON in line " + std::to_string(line) + " of the GLB",
        advice);
  } catch (const Json::out_of_range&) {
    throw InputError(path_, "a number in the JSON is too large for a double",
                     "scale the coordinates down");
  }
}

void GltfDocument::CheckVersion() const {
  const GltfValue asset = root().At("asset");
  for (const char* key : {"version", "minVersion"}) {
    if (key == std::string_view("minVersion") && !asset.Has(key)) continue;
    const GltfValue version = asset.At(key);
    const bool is_known = key == std::string_view("version")
                              ? version.Text().starts_with("2.")
                              : version.Text() == "2.0";
    if (!is_known) {
      version.Fail("is " + Quoted(version.Text()), "convert it to glTF 2.0");
    }
  }
}

void GltfDocument::CheckExtensions() const {
  if (!root().Has("extensionsRequired")) return;
  const GltfValue required = root().At("extensionsRequired");
  for (std::size_t i = 0; i < required.size(); ++i) {
    const std::string& name = required.At(i).Text();
    const bool is_harmless = std::any_of(
        kHarmless.begin(), kHarmless.end(),
        [&name](std::string_view known) { return name.starts_with(known); });
    if (is_harmless) continue;
    required.Fail("has " + Quoted(name) + ", which is not read",
                  "export the mesh without it, as uncompressed triangles");
  }
}

GltfValue GltfDocument::Refer(const GltfValue& index, const char* array) const {
  const GltfValue all = root().At(array);
  const std::uint64_t i = index.Whole();
  if (i >= all.size()) {
    index.Fail("is " + std::to_string(i) + ", and " + array + " has " +
               std::to_string(all.size()));
  }
  return all.At(static_cast<std::size_t>(i));
}

}  // namespace halfspace::bench
