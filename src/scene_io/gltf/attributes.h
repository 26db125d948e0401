// Attributes of one glTF primitive, from Draco where it has them and from accessors otherwise.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene_io/gltf/document.h"
#include "scene_io/gltf/draco.h"
#include "scene_io/gltf/primitive.h"

namespace kairos::gltf {

class AttributeReader {
 public:
  /// The primitive has a POSITION, and lives as long as the reader. Throws Error for what cannot be decoded.
  AttributeReader(Document& document, const file::Primitive& source, const std::string& where);

  size_t vertex_count() const { return position_->count; }
  bool is_draco() const { return draco_.has_value(); }
  bool has(const std::string& name) const { return source_.attributes.count(name) != 0; }
  const file::Accessor& accessor(const std::string& name) const;

  /// One element per vertex, flattened. Throws Error for an accessor that has not so many, or of another kind.
  std::vector<float> floats(const std::string& name, int components);
  std::vector<uint32_t> integers(const std::string& name, int components);

  /// Vertices in the order in which triangles have them; not checked.
  std::vector<uint32_t> corners();

  /// Throws unless the accessor has one element per vertex.
  int checked_accessor(int accessor, const std::string& name) const;

 private:
  void decode(const file::Draco& draco);

  Document& document_;
  const file::Primitive& source_;
  std::string where_;
  const file::Accessor* position_;
  std::optional<DracoMesh> draco_;
  std::map<std::string, uint32_t> draco_ids_;
};

/// Texture coordinates, tangents and colours, as far as the material has a use for them.
void read_surface_attributes(AttributeReader& attributes, const Material& material, const std::string& where,
                             Primitive& primitive, Warnings& warnings);

/// Tangents for a primitive that wants and lacks them, when all else is there. Vertices whose triangles show the
/// picture in different ways are split.
void add_tangents(Document& document, const Material& material, const std::string& where, Primitive& primitive);

}  // namespace kairos::gltf
