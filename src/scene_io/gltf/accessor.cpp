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

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;  // 2x2 and 3x3 matrices have padding, and nothing that is read here uses them
  }
}

/// Offsets of a view's elements: one every `stride` bytes.
struct Elements {
  const uint8_t* data = nullptr;
  uint64_t stride = 0;
};

Elements dense_elements(const Document& document, const tinygltf::Accessor& accessor, uint64_t element_size,
                        const std::string& where) {
  const auto& views = document.model.bufferViews;
  if (accessor.bufferView < 0) return {};
  if (static_cast<size_t>(accessor.bufferView) >= views.size()) document.fail(where, "its buffer view does not exist");
  const uint64_t view_stride = views[static_cast<size_t>(accessor.bufferView)].byteStride;
  const uint64_t stride = view_stride == 0 ? element_size : view_stride;
  if (stride < element_size) document.fail(where, "its elements are larger than its buffer view's byteStride");
  if (accessor.count > (uint64_t{1} << 40)) document.fail(where, "has an absurd number of elements");
  const uint64_t length = accessor.count == 0 ? 0 : (accessor.count - 1) * stride + element_size;
  return {view_bytes(document, accessor.bufferView, accessor.byteOffset, length, where).data(), stride};
}

/// Calls convert(bytes) for every component, in order, and puts what it returns into the result.
template <class T, class Convert>
std::vector<T> read(Document& document, const tinygltf::Accessor& accessor, int components, const std::string& where,
                    const Convert& convert) {
  const uint64_t size = component_size(accessor.componentType), element_size = size * static_cast<uint64_t>(components);
  const uint64_t width = static_cast<uint64_t>(components);
  const Elements dense = dense_elements(document, accessor, element_size, where);
  document.charge(accessor.count * width * sizeof(T), where);
  std::vector<T> values(accessor.count * width);
  if (dense.data)
    for (uint64_t i = 0; i < accessor.count; ++i)
      for (uint64_t c = 0; c < width; ++c) values[i * width + c] = convert(dense.data + i * dense.stride + c * size);
  if (!accessor.sparse.isSparse) return values;

  const auto& sparse = accessor.sparse;
  const uint64_t index_size = sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                              : sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                              : sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT   ? 4
                                                                                                       : 0;
  if (index_size == 0) document.fail(where, "its sparse indices have a component type that is no unsigned integer");
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    document.fail(where, "its sparse part has a negative count or offset");
  const auto count = static_cast<uint64_t>(sparse.count);
  if (count > accessor.count) document.fail(where, "replaces more elements than it has");
  const auto indices = view_bytes(document, sparse.indices.bufferView, static_cast<uint64_t>(sparse.indices.byteOffset),
                                  count * index_size, where);
  const auto replacements = view_bytes(document, sparse.values.bufferView,
                                       static_cast<uint64_t>(sparse.values.byteOffset), count * element_size, where);
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

const tinygltf::Accessor& typed_accessor(const Document& document, int index, int components, const std::string& user,
                                         const std::string& where) {
  const tinygltf::Accessor& accessor = get_accessor(document, index, user);
  if (component_count(accessor.type) != components)
    document.fail(where, fmt::format("has the wrong type for {}, which needs {} components", user, components));
  if (component_size(accessor.componentType) == 0)
    document.fail(where, fmt::format("has the unknown component type {}", accessor.componentType));
  return accessor;
}

}  // namespace

uint64_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
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
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return scaled(load<int8_t>(bytes), 127);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return scaled(load<uint8_t>(bytes), 255);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return scaled(load<int16_t>(bytes), 32767);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return scaled(load<uint16_t>(bytes), 65535);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<uint32_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(bytes);
    default:
      return 0;
  }
}

const tinygltf::Accessor& get_accessor(const Document& document, int index, const std::string& user) {
  const auto& accessors = document.model.accessors;
  if (index < 0 || static_cast<size_t>(index) >= accessors.size())
    document.fail(user, fmt::format("names accessor {}, but there are {}", index, accessors.size()));
  return accessors[static_cast<size_t>(index)];
}

std::span<const uint8_t> view_bytes(const Document& document, int view, uint64_t offset, uint64_t length,
                                    const std::string& where) {
  const auto& views = document.model.bufferViews;
  if (view < 0 || static_cast<size_t>(view) >= views.size())
    document.fail(where, fmt::format("names buffer view {}, but there are {}", view, views.size()));
  const tinygltf::BufferView& v = views[static_cast<size_t>(view)];
  const std::string view_where = at("bufferViews", static_cast<size_t>(view));
  if (v.buffer < 0 || static_cast<size_t>(v.buffer) >= document.buffers.size())
    document.fail(view_where, fmt::format("names buffer {}, but there are {}", v.buffer, document.buffers.size()));
  const auto buffer = document.buffers[static_cast<size_t>(v.buffer)];
  if (v.byteOffset > buffer.size() || v.byteLength > buffer.size() - v.byteOffset)
    document.fail(view_where, fmt::format("reaches beyond the {} bytes of its buffer", buffer.size()));
  if (offset > v.byteLength || length > v.byteLength - offset)
    document.fail(where, fmt::format("reaches beyond the {} bytes of its buffer view", v.byteLength));
  return buffer.subspan(v.byteOffset + offset, length);
}

std::vector<float> read_floats(Document& document, int index, int components, const std::string& user) {
  const std::string where = at("accessors", static_cast<size_t>(std::max(index, 0)));
  const tinygltf::Accessor& accessor = typed_accessor(document, index, components, user, where);
  const int type = accessor.componentType;
  if (type == TINYGLTF_COMPONENT_TYPE_FLOAT)
    return read<float>(document, accessor, components, where, [](const uint8_t* bytes) { return load<float>(bytes); });
  const bool normalized = accessor.normalized;
  return read<float>(document, accessor, components, where, [type, normalized](const uint8_t* bytes) {
    return static_cast<float>(component_value(bytes, type, normalized));
  });
}

std::vector<uint32_t> read_integers(Document& document, int index, int components, const std::string& user) {
  const std::string where = at("accessors", static_cast<size_t>(std::max(index, 0)));
  const tinygltf::Accessor& accessor = typed_accessor(document, index, components, user, where);
  switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read<uint32_t>(document, accessor, components, where, [](const uint8_t* b) { return uint32_t{*b}; });
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read<uint32_t>(document, accessor, components, where,
                            [](const uint8_t* b) { return uint32_t{load<uint16_t>(b)}; });
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return read<uint32_t>(document, accessor, components, where, [](const uint8_t* b) { return load<uint32_t>(b); });
    default:
      document.fail(where, "must hold unsigned integers, for " + user);
  }
}

}  // namespace kairos::gltf
