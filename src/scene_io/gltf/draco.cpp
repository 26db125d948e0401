#include "scene_io/gltf/draco.h"

#include <exception>

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <kairos/printable.h>

#include "scene_io/gltf/accessor.h"

namespace kairos::gltf {

namespace {

int component_type(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return file::kByte;
    case draco::DT_UINT8:
    case draco::DT_BOOL:
      return file::kUnsignedByte;
    case draco::DT_INT16:
      return file::kShort;
    case draco::DT_UINT16:
      return file::kUnsignedShort;
    case draco::DT_UINT32:
      return file::kUnsignedInt;
    case draco::DT_FLOAT32:
      return file::kFloat;
    default:
      return -1;
  }
}

}  // namespace

DracoMesh::DracoMesh(Document& document, std::span<const uint8_t> bytes, uint64_t points, uint64_t corners,
                     const std::string& where)
    : where_(where) {
  // Draco's own structures: a mesh's corners with their connectivity, and every attribute's values and mapping.
  constexpr uint64_t kBytesPerCorner = 16, kBytesPerPoint = 64;
  document.charge(points * kBytesPerPoint + corners * kBytesPerCorner, where);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  try {
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok())
      document.fail(where, "cannot be decoded by Draco: " + printable(result.status().error_msg_string()));
    mesh_ = std::move(result).value();
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {  // Draco believes the counts in its own header and allocates accordingly
    document.fail(where, "cannot be decoded by Draco: it runs out of memory");
  }
  if (mesh_->num_points() != points || (corners != 0 && uint64_t{mesh_->num_faces()} * 3 != corners))
    document.fail(where, fmt::format("Draco holds {} points and {} triangles, the accessors say {} and {}",
                                     mesh_->num_points(), mesh_->num_faces(), points, corners / 3));
}

std::vector<uint32_t> DracoMesh::indices(Document& document) const {
  document.charge(uint64_t{mesh_->num_faces()} * 3 * sizeof(uint32_t), where_);
  std::vector<uint32_t> result;
  result.reserve(size_t{mesh_->num_faces()} * 3);
  for (draco::FaceIndex f(0); f < mesh_->num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh_->face(f)) result.push_back(corner.value());
  return result;
}

std::vector<float> DracoMesh::floats(Document& document, uint32_t id, int components, bool normalized) const {
  const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(id);
  if (!attribute) document.fail(where_, fmt::format("Draco holds no attribute {}", id));
  const int type = component_type(attribute->data_type());
  if (attribute->num_components() != components || type < 0)
    document.fail(where_, fmt::format("Draco's attribute {} has the wrong type", id));
  const uint64_t points = mesh_->num_points();
  if (!attribute->is_mapping_identity() && attribute->indices_map_size() < points)
    document.fail(where_, fmt::format("Draco's attribute {} misses points", id));
  const auto width = static_cast<uint64_t>(components);
  const uint64_t size = component_size(type), available = attribute->buffer()->data_size();
  document.charge(points * width * sizeof(float), where_);
  std::vector<float> values(points * width);
  for (uint32_t p = 0; p < points; ++p) {
    const uint64_t entry = attribute->mapped_index(draco::PointIndex(p)).value();
    const uint64_t offset =
        static_cast<uint64_t>(attribute->byte_offset()) + entry * static_cast<uint64_t>(attribute->byte_stride());
    if (entry >= attribute->size() || offset > available || size * width > available - offset)
      document.fail(where_, fmt::format("Draco's attribute {} is broken", id));
    const uint8_t* bytes = attribute->buffer()->data() + offset;
    for (uint64_t c = 0; c < width; ++c)
      values[p * width + c] = static_cast<float>(component_value(bytes + c * size, type, normalized));
  }
  return values;
}

}  // namespace kairos::gltf
