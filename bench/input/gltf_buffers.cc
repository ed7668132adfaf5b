#include "bench/input/gltf_buffers.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <system_error>

#include "bench/input/input_file.h"
#include "bench/input/text_lines.h"

namespace halfspace::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDataScheme = "data:";

// Nothing if `text` is no base64 (RFC 4648), with or without its padding.
std::optional<std::string> DecodedBase64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  if (text.size() % 4 == 0) {
    for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  }
  if (text.size() % 4 == 1) return std::nullopt;
  std::array<int, 256> value;
  value.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i) {
    value[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  }
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = value[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFF);
  }
  return bytes;
}

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// With %20 and the like as the characters that they stand for.
std::string Unescaped(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = i + 2 < uri.size() ? HexDigit(uri[i + 1]) : -1;
    const int low = i + 2 < uri.size() ? HexDigit(uri[i + 2]) : -1;
    if (uri[i] == '%' && high >= 0 && low >= 0) {
      text += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

// A file in the folder of the glTF, or below it. Colons are those of schemes
// and of Windows' drives.
bool IsBelow(const std::string& name) {
  const fs::path path(name);
  const bool is_plain = !name.empty() && name.find_first_of(std::string_view(
                                             "\0\\:", 3)) == std::string::npos;
  return is_plain && path.is_relative() &&
         std::find(path.begin(), path.end(), "..") == path.end();
}

}  // namespace

std::string_view GltfBuffers::ViewBytes(const GltfValue& view) {
  const GltfValue buffer = document_.Refer(view.At("buffer"), "buffers");
  const std::string_view bytes = BytesOf(buffer);
  const std::uint64_t offset = view.Whole("byteOffset", 0);
  const std::uint64_t length = view.At("byteLength").Whole();
  if (offset > bytes.size() || length > bytes.size() - offset) {
    view.Fail("ends at byte " + std::to_string(offset + length) + " of " +
              buffer.place() + ", which has " + std::to_string(bytes.size()));
  }
  return bytes.substr(offset, length);
}

std::string_view GltfBuffers::BytesOf(const GltfValue& buffer) {
  const auto length = static_cast<std::size_t>(buffer.At("byteLength").Whole());
  std::string_view bytes;
  if (buffer.Has("uri")) {
    const bool is_text = buffer.At("uri").Text().starts_with(kDataScheme);
    bytes = is_text ? TextBytes(buffer) : FileBytes(buffer);
  } else if (buffer.place() == "buffers[0]" && document_.bin()) {
    bytes = *document_.bin();
  } else {
    buffer.Fail("has no uri, and is not the first of a GLB with a BIN chunk",
                "export the mesh uncompressed, with its buffers");
  }
  if (bytes.size() < length) {
    buffer.Fail("has " + std::to_string(bytes.size()) +
                    " bytes, and its byteLength is " + std::to_string(length),
                "copy the files again, one may be truncated");
  }
  return bytes.substr(0, length);
}

std::string_view GltfBuffers::TextBytes(const GltfValue& buffer) {
  const auto [known, is_new] = texts_.try_emplace(buffer.place());
  if (!is_new) return known->second;
  constexpr std::string_view kBase64 = ";base64,";
  const GltfValue uri = buffer.At("uri");
  const std::string_view text = uri.Text();
  const std::size_t begin = text.find(kBase64);
  if (begin == std::string_view::npos) uri.Fail("is no base64");
  auto bytes = DecodedBase64(text.substr(begin + kBase64.size()));
  if (!bytes) uri.Fail("is no base64");
  known->second = *std::move(bytes);
  return known->second;
}

std::string_view GltfBuffers::FileBytes(const GltfValue& buffer) {
  const GltfValue uri = buffer.At("uri");
  const std::string name = Unescaped(uri.Text());
  if (!IsBelow(name)) {
    uri.Fail("is " + Quoted(uri.Text()) + ", outside the folder of the file",
             "give a glTF whose buffers are beside or below it, or a GLB");
  }
  std::error_code error;
  const fs::path folder =
      fs::canonical(fs::absolute(document_.path()).parent_path(), error);
  const fs::path canonical = fs::canonical(folder / name, error);
  if (error || !fs::is_regular_file(canonical, error)) {
    uri.Fail("is " + Quoted(uri.Text()) + ", and there is no such file",
             "put the buffer where the file says, or give a GLB");
  }
  // A link may lead anywhere.
  if (canonical.lexically_relative(folder).native().starts_with("..")) {
    uri.Fail("is " + Quoted(uri.Text()) + ", a link out of the folder",
             "put the file itself there, or give a GLB");
  }
  const auto [known, is_new] = files_.try_emplace(canonical.string());
  if (!is_new) return known->second;
  if (buffer.At("byteLength").Whole() > left_) {
    buffer.Fail("takes more than the memory that is free",
                "give a smaller one");
  }
  known->second =
      ReadBytes(canonical.string(), std::min(LargestBuffer(), left_));
  left_ -= known->second.size();
  return known->second;
}

// No file is read further: another buffer may be the same file.
std::size_t GltfBuffers::LargestBuffer() const {
  const GltfValue buffers = document_.root().At("buffers");
  std::uint64_t largest = 0;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    largest = std::max(largest, buffers.At(i).At("byteLength").Whole());
  }
  return static_cast<std::size_t>(largest);
}

}  // namespace halfspace::bench
