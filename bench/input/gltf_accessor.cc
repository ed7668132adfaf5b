#include "bench/input/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "bench/input/little_endian.h"
#include "bench/input/text_lines.h"

namespace halfspace::bench {

GltfAccessor::GltfAccessor(const GltfDocument& document, GltfBuffers& buffers,
                           GltfValue accessor, GltfKind kind)
    : accessor_(std::move(accessor)), kind_(kind) {
  const std::string_view wanted =
      kind == GltfKind::kPositions ? "VEC3" : "SCALAR";
  const GltfValue type = accessor_.At("type");
  if (type.Text() != wanted) {
    type.Fail("is " + Quoted(type.Text()) + ", where " + std::string(wanted) +
              " is needed");
  }
  elements_.components = kind == GltfKind::kPositions ? 3 : 1;
  elements_.component = ComponentOf(accessor_, kind);
  elements_.is_normalized =
      kind == GltfKind::kPositions && accessor_.Flag("normalized");
  elements_.count = static_cast<std::size_t>(accessor_.At("count").Whole());
  if (elements_.count == 0) accessor_.Fail("has no elements");
  if (!accessor_.Has("bufferView")) {
    accessor_.Fail(
        "has no bufferView: it is compressed, or sparse over zeros, neither of "
        "which is read",
        "export the mesh uncompressed, its positions in full");
  }
  Place(document, buffers, accessor_, elements_);
  if (accessor_.Has("sparse")) ReadSparse(document, buffers);
}

// Finds the elements that `owner` places in a buffer view.
void GltfAccessor::Place(const GltfDocument& document, GltfBuffers& buffers,
                         const GltfValue& owner, Elements& elements) const {
  const GltfValue view = document.Refer(owner.At("bufferView"), "bufferViews");
  const std::string_view bytes = buffers.ViewBytes(view);
  const std::size_t size = BytesOf(elements.component) * elements.components;
  const std::uint64_t offset = owner.Whole("byteOffset", 0);
  const std::uint64_t stride = view.Whole("byteStride", size);
  constexpr std::uint64_t kMostStride = 252;
  if (stride < size || stride > kMostStride) {
    view.Fail("has a byteStride of " + std::to_string(stride) +
              ", where elements have " + std::to_string(size) + " bytes");
  }
  // No overflow: the offset is below 2^53, and the count no more than the
  // bytes.
  const bool is_within =
      elements.count <= bytes.size() &&
      offset + stride * (elements.count - 1) + size <= bytes.size();
  if (!is_within) {
    owner.Fail("has " + std::to_string(elements.count) +
               " elements, more than its bufferView of " +
               std::to_string(bytes.size()) + " bytes holds");
  }
  elements.bytes = bytes.substr(offset);
  elements.stride = static_cast<std::size_t>(stride);
}

void GltfAccessor::ReadSparse(const GltfDocument& document,
                              GltfBuffers& buffers) {
  const GltfValue sparse = accessor_.At("sparse");
  const GltfValue indices = sparse.At("indices");
  const std::uint64_t count = sparse.At("count").Whole();
  if (count == 0 || count > elements_.count) {
    sparse.Fail("has a count of " + std::to_string(count) + ", where " +
                accessor_.place() + " has " + std::to_string(elements_.count));
  }
  sparse_indices_.count = static_cast<std::size_t>(count);
  sparse_indices_.component = ComponentOf(indices, GltfKind::kIndices);
  Place(document, buffers, indices, sparse_indices_);
  sparse_values_ = elements_;
  sparse_values_.count = static_cast<std::size_t>(count);
  Place(document, buffers, sparse.At("values"), sparse_values_);
}

std::vector<double> GltfAccessor::Values() const {
  const std::size_t n = elements_.components;
  std::vector<double> values;
  values.reserve(count() * n);
  for (std::size_t i = 0; i < count(); ++i) {
    for (std::size_t c = 0; c < n; ++c) values.push_back(elements_.Get(i, c));
  }
  for (std::size_t i = 0; i < sparse_indices_.count; ++i) {
    const double at = sparse_indices_.Get(i, 0);
    if (at >= static_cast<double>(count())) {
      accessor_.At("sparse").Fail("replaces an element after the last");
    }
    for (std::size_t c = 0; c < n; ++c) {
      values[static_cast<std::size_t>(at) * n + c] = sparse_values_.Get(i, c);
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) Check(values[i], i / n);
  return values;
}

void GltfAccessor::Check(double value, std::size_t element) const {
  if (!std::isfinite(value)) {
    accessor_.Fail("has a coordinate at element " + std::to_string(element) +
                   " that is not a finite number");
  }
  if (kind_ == GltfKind::kIndices && value == Greatest(elements_.component)) {
    accessor_.Fail(
        "has at element " + std::to_string(element) +
            " the greatest index of its type, which restarts a strip",
        "export the mesh without restarts");
  }
}

double GltfAccessor::Elements::Get(std::size_t element,
                                   std::size_t component_index) const {
  const std::size_t size = GltfAccessor::BytesOf(component);
  const std::uint32_t bits = LittleEndian(
      bytes.substr(element * stride + component_index * size, size));
  double value = bits;
  if (component == Component::kFloat) return std::bit_cast<float>(bits);
  if (component == Component::kInt8) value = static_cast<std::int8_t>(bits);
  if (component == Component::kInt16) value = static_cast<std::int16_t>(bits);
  return is_normalized ? std::max(value / Greatest(component), -1.0) : value;
}

GltfAccessor::Component GltfAccessor::ComponentOf(const GltfValue& owner,
                                                  GltfKind kind) {
  constexpr std::array kOfPositions = {Component::kInt8, Component::kUint8,
                                       Component::kInt16, Component::kUint16,
                                       Component::kFloat};
  constexpr std::array kOfIndices = {Component::kUint8, Component::kUint16,
                                     Component::kUint32};
  const bool is_position = kind == GltfKind::kPositions;
  const std::span<const Component> known =
      is_position ? std::span<const Component>(kOfPositions) : kOfIndices;
  const GltfValue type = owner.At("componentType");
  const std::uint64_t number = type.Whole();
  for (const Component component : known) {
    if (number == static_cast<std::uint64_t>(component)) return component;
  }
  type.Fail("is " + std::to_string(number) + ", which no " +
            (is_position ? "position" : "index") + " has");
}

std::size_t GltfAccessor::BytesOf(Component component) {
  switch (component) {
    case Component::kInt8:
    case Component::kUint8:
      return 1;
    case Component::kInt16:
    case Component::kUint16:
      return 2;
    default:
      return 4;
  }
}

double GltfAccessor::Greatest(Component component) {
  switch (component) {
    case Component::kInt8:
      return 0x7F;
    case Component::kUint8:
      return 0xFF;
    case Component::kInt16:
      return 0x7FFF;
    case Component::kUint16:
      return 0xFFFF;
    default:
      return 0xFFFFFFFF;
  }
}

}  // namespace halfspace::bench
