#include "scene_io/gltf/attributes.h"

#include <limits>
#include <numeric>

#include <fmt/format.h>

#include <kairos/printable.h>

#include "scene_io/gltf/accessor.h"

namespace kairos::gltf {

AttributeReader::AttributeReader(Document& document, const file::Primitive& source, const std::string& where)
    : document_(document), source_(source), where_(where) {
  position_ = &get_accessor(document, source.attributes.at("POSITION"), where + ".attributes.POSITION");
  if (position_->count > std::numeric_limits<uint32_t>::max())
    document.fail(at("accessors", static_cast<size_t>(source.attributes.at("POSITION"))),
                  "has more than 2^32 vertices");
  if (source.draco) decode(*source.draco);
}

const file::Accessor& AttributeReader::accessor(const std::string& name) const {
  return get_accessor(document_, source_.attributes.at(name), where_ + ".attributes." + printable(name));
}

std::vector<float> AttributeReader::floats(const std::string& name, int components) {
  const int index = checked_accessor(source_.attributes.at(name), name);
  if (const auto id = draco_ids_.find(name); id != draco_ids_.end())
    return draco_->floats(document_, id->second, components, get_accessor(document_, index, name).normalized);
  return read_floats(document_, index, components, where_ + ".attributes." + printable(name));
}

std::vector<uint32_t> AttributeReader::integers(const std::string& name, int components) {
  if (draco_ids_.count(name)) {
    const std::vector<float> values = floats(name, components);
    std::vector<uint32_t> result(values.size());
    for (size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] >= 0 && values[i] <= 65535)) document_.fail(where_, "Draco's " + name + " are no joints");
      result[i] = static_cast<uint32_t>(values[i]);
    }
    return result;
  }
  return read_integers(document_, checked_accessor(source_.attributes.at(name), name), components,
                       where_ + ".attributes." + printable(name));
}

std::vector<uint32_t> AttributeReader::corners() {
  if (draco_) return draco_->indices(document_);
  if (source_.indices >= 0) return read_integers(document_, source_.indices, 1, where_ + ".indices");
  document_.charge(vertex_count() * sizeof(uint32_t), where_);
  std::vector<uint32_t> all(vertex_count());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

int AttributeReader::checked_accessor(int accessor, const std::string& name) const {
  const uint64_t count = get_accessor(document_, accessor, where_ + "." + printable(name)).count;
  if (count != vertex_count())
    document_.fail(where_,
                   fmt::format("its {} has {} elements, but POSITION has {}", printable(name), count, vertex_count()));
  return accessor;
}

void AttributeReader::decode(const file::Draco& draco) {
  const std::string where = where_ + ".extensions.KHR_draco_mesh_compression";
  for (const auto& [name, id] : draco.attributes) draco_ids_[name] = static_cast<uint32_t>(id);
  const auto& views = document_.model.bufferViews;
  if (draco.bufferView < 0 || static_cast<size_t>(draco.bufferView) >= views.size())
    document_.fail(where, fmt::format("names buffer view {}, which does not exist", draco.bufferView));
  const uint64_t length = views[static_cast<size_t>(draco.bufferView)].byteLength;
  const bool is_list = source_.mode == file::kTriangles && source_.indices >= 0;
  const uint64_t corners = is_list ? get_accessor(document_, source_.indices, where_ + ".indices").count : 0;
  draco_.emplace(document_, document_.view_bytes(draco.bufferView, 0, length, where), vertex_count(), corners, where);
}

}  // namespace kairos::gltf
