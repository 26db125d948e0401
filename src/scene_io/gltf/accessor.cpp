#include "scene_io/gltf/accessor.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace kairos::gltf {

namespace {

template <class T>
T load(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Offsets of a view's elements: one every `stride` bytes.
struct Elements {
  const uint8_t* data = nullptr;
  uint64_t stride = 0;
};

Elements dense_elements(Document& document, const file::Accessor& accessor, uint64_t element_size,
                        const std::string& where) {
  const auto& views = document.model.bufferViews;
  if (accessor.bufferView < 0 || accessor.count == 0) return {};
  if (static_cast<size_t>(accessor.bufferView) >= views.size()) document.fail(where, "its buffer view does not exist");
  const uint64_t view_stride = views[static_cast<size_t>(accessor.bufferView)].byteStride;
  const uint64_t stride = view_stride == 0 ? element_size : view_stride;
  if (stride < element_size) document.fail(where, "its elements are larger than its buffer view's byteStride");
  if (accessor.count > (uint64_t{1} << 40)) document.fail(where, "has an absurd number of elements");
  const uint64_t length = (accessor.count - 1) * stride + element_size;
  return {document.view_bytes(accessor.bufferView, accessor.byteOffset, length, where).data(), stride};
}

/// Calls convert(bytes) for every component, in order, and puts what it returns into the result.
template <class T, class Convert>
std::vector<T> read(Document& document, const file::Accessor& accessor, int components, const std::string& where,
                    const Convert& convert) {
  const uint64_t size = component_size(accessor.componentType), element_size = size * static_cast<uint64_t>(components);
  const uint64_t width = static_cast<uint64_t>(components);
  const Elements dense = dense_elements(document, accessor, element_size, where);
  document.charge(accessor.count * width * sizeof(T), where);
  std::vector<T> values(accessor.count * width);
  if (dense.data)
    for (uint64_t i = 0; i < accessor.count; ++i)
      for (uint64_t c = 0; c < width; ++c) values[i * width + c] = convert(dense.data + i * dense.stride + c * size);
  if (!accessor.sparse) return values;

  const file::Sparse& sparse = *accessor.sparse;
  const uint64_t index_size = sparse.indices.componentType == file::kUnsignedByte    ? 1
                              : sparse.indices.componentType == file::kUnsignedShort ? 2
                              : sparse.indices.componentType == file::kUnsignedInt   ? 4
                                                                                     : 0;
  if (index_size == 0) document.fail(where, "its sparse indices have a component type that is no unsigned integer");
  const uint64_t count = sparse.count;
  if (count > accessor.count) document.fail(where, "replaces more elements than it has");
  const auto indices =
      document.view_bytes(sparse.indices.bufferView, sparse.indices.byteOffset, count * index_size, where);
  const auto replacements =
      document.view_bytes(sparse.values.bufferView, sparse.values.byteOffset, count * element_size, where);
  for (uint64_t i = 0; i < count; ++i) {
    const auto index =
        static_cast<uint64_t>(component_value(indices.data() + i * index_size, sparse.indices.componentType, false));
    if (index >= accessor.count)
      document.fail(where, fmt::format("replaces element {}, which it does not have", index));
    for (uint64_t c = 0; c < width; ++c)
      values[index * width + c] = convert(replacements.data() + i * element_size + c * size);
  }
  return values;
}

const file::Accessor& typed_accessor(const Document& document, int index, int components, const std::string& user,
                                     const std::string& where) {
  const file::Accessor& accessor = get_accessor(document, index, user);
  if (accessor.components != components)
    document.fail(where, fmt::format("has the wrong type for {}, which needs {} components", user, components));
  if (component_size(accessor.componentType) == 0)
    document.fail(where, fmt::format("has the unknown component type {}", accessor.componentType));
  return accessor;
}

}  // namespace

uint64_t component_size(int type) {
  switch (type) {
    case file::kByte:
    case file::kUnsignedByte:
      return 1;
    case file::kShort:
    case file::kUnsignedShort:
      return 2;
    case file::kUnsignedInt:
    case file::kFloat:
      return 4;
    default:
      return 0;
  }
}

double component_value(const uint8_t* bytes, int type, bool normalized) {
  const auto scaled = [&](double value, double largest) {
    return normalized ? std::max(value / largest, -1.0) : value;
  };
  switch (type) {
    case file::kByte:
      return scaled(load<int8_t>(bytes), 127);
    case file::kUnsignedByte:
      return scaled(load<uint8_t>(bytes), 255);
    case file::kShort:
      return scaled(load<int16_t>(bytes), 32767);
    case file::kUnsignedShort:
      return scaled(load<uint16_t>(bytes), 65535);
    case file::kUnsignedInt:
      return load<uint32_t>(bytes);
    case file::kFloat:
      return load<float>(bytes);
    default:
      return 0;
  }
}

const file::Accessor& get_accessor(const Document& document, int index, const std::string& user) {
  const auto& accessors = document.model.accessors;
  if (index < 0 || static_cast<size_t>(index) >= accessors.size())
    document.fail(user, fmt::format("names accessor {}, but there are {}", index, accessors.size()));
  return accessors[static_cast<size_t>(index)];
}

std::vector<float> read_floats(Document& document, int index, int components, const std::string& user) {
  const std::string where = at("accessors", static_cast<size_t>(std::max(index, 0)));
  const file::Accessor& accessor = typed_accessor(document, index, components, user, where);
  const int type = accessor.componentType;
  if (type == file::kFloat)
    return read<float>(document, accessor, components, where, [](const uint8_t* bytes) { return load<float>(bytes); });
  const bool normalized = accessor.normalized;
  return read<float>(document, accessor, components, where, [type, normalized](const uint8_t* bytes) {
    return static_cast<float>(component_value(bytes, type, normalized));
  });
}

std::vector<uint32_t> read_integers(Document& document, int index, int components, const std::string& user) {
  const std::string where = at("accessors", static_cast<size_t>(std::max(index, 0)));
  const file::Accessor& accessor = typed_accessor(document, index, components, user, where);
  switch (accessor.componentType) {
    case file::kUnsignedByte:
      return read<uint32_t>(document, accessor, components, where, [](const uint8_t* b) { return uint32_t{*b}; });
    case file::kUnsignedShort:
      return read<uint32_t>(document, accessor, components, where,
                            [](const uint8_t* b) { return uint32_t{load<uint16_t>(b)}; });
    case file::kUnsignedInt:
      return read<uint32_t>(document, accessor, components, where, [](const uint8_t* b) { return load<uint32_t>(b); });
    default:
      document.fail(where, "must hold unsigned integers, for " + user);
  }
}

}  // namespace kairos::gltf
