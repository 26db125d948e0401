#include "scene_io/gltf/document.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include <kairos/printable.h>

#include "base/file.h"
#include "scene_io/gltf/meshopt.h"
#include "scene_io/json_text.h"
#include "scene_io/not_a_scene.h"

namespace kairos::gltf {

namespace {

constexpr uint64_t kMaxJsonBytes = uint64_t{1} << 30;
constexpr uint64_t kMaxBufferBytes = uint64_t{1} << 34;

struct Chunks {
  std::span<const uint8_t> json, binary;
};

/// The parts of a GLB container, or a plain .gltf as it is.
Chunks split_container(std::span<const uint8_t> bytes, const std::string& name) {
  const auto fail = [&](const std::string& message) -> void { throw Error(ErrorCode::bad_input, name, message); };
  constexpr std::string_view kMagic = "glTF";
  if (bytes.size() < 4 || std::memcmp(bytes.data(), kMagic.data(), 4) != 0) return {bytes, {}};
  const auto word = [&](uint64_t offset) {
    uint32_t value = 0;
    for (uint64_t i = 0; i < 4; ++i) value |= uint32_t{bytes[offset + i]} << (8 * i);
    return value;
  };
  constexpr uint64_t kHeader = 12, kChunkHeader = 8;
  constexpr uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (bytes.size() < kHeader + kChunkHeader) fail("is cut short: a GLB has at least 20 bytes");
  if (word(4) != 2) fail(fmt::format("is a GLB of glTF {}.0, and only 2.0 is supported; convert the file", word(4)));
  const uint64_t length = word(8);
  if (length > bytes.size())
    fail(fmt::format("is cut short: its header promises {} bytes, it has {}", length, bytes.size()));
  Chunks chunks;
  bool has_json = false, has_binary = false;
  for (uint64_t offset = kHeader; offset + kChunkHeader <= length;) {
    const uint64_t size = word(offset);
    const uint32_t type = word(offset + 4);
    offset += kChunkHeader;
    if (size > length - offset) fail(fmt::format("a GLB chunk of {} bytes reaches beyond the end of the file", size));
    if (!has_json && type != kJson) fail("the first chunk of a GLB must be JSON");
    const auto chunk = bytes.subspan(offset, size);
    if (!has_json) chunks.json = chunk;
    if (has_json && !has_binary && type == kBinary) {
      chunks.binary = chunk;
      has_binary = true;
    }
    has_json = true;
    offset += size;
  }
  if (!has_json) fail("the GLB has no JSON chunk");
  return chunks;
}

std::string_view json_text(std::span<const uint8_t> bytes, const std::string& name) {
  if (bytes.size() > kMaxJsonBytes) throw Error(ErrorCode::bad_input, name, "holds more than 1 GiB of JSON");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::string at(const char* array, size_t index) { return fmt::format("{}[{}]", array, index); }

void Document::fail(const std::string& where, const std::string& message) const {
  throw Error(ErrorCode::bad_input, name + ": " + where, message);
}

void Document::charge(uint64_t bytes, const std::string& where) { budget->charge(bytes, name + ": " + where); }

std::string path_of_uri(const Document& document, const std::string& uri, const std::string& where) {
  constexpr size_t kLongest = 4096;
  if (uri.size() > kLongest)
    document.fail(where, fmt::format("names a file by {} characters; a data: URI begins with 'data:'", uri.size()));
  std::string relative = percent_decode(uri);
  std::replace(relative.begin(), relative.end(), '\\', '/');
  if (document.folder.path.empty())
    document.fail(where, "names the file '" + printable(relative) + "', but only this one is read");
  return document.folder.resolve(relative, document.name + ": " + where);
}

std::span<const uint8_t> Document::buffer(int index, const std::string& user) {
  if (index < 0 || static_cast<size_t>(index) >= model.buffers.size())
    fail(user, fmt::format("names buffer {}, but there are {}", index, model.buffers.size()));
  if (const auto known = buffers_.find(index); known != buffers_.end()) return known->second;
  const file::Buffer& source = model.buffers[static_cast<size_t>(index)];
  const std::string where = at("buffers", static_cast<size_t>(index));
  std::span<const uint8_t> bytes;
  if (source.uri.empty()) {
    if (index != 0 || binary.empty()) fail(where, "has no uri, and the file has no binary chunk for it");
    bytes = binary;
  } else if (is_data_uri(source.uri)) {
    bytes = data_[index] = decode_data_uri(source.uri, name + ": " + where);
  } else {
    const std::string path = path_of_uri(*this, source.uri, where);
    const auto [file, is_new] = files_.try_emplace(path);
    if (is_new) {
      uint64_t total = 0;
      for (const auto& [other, read] : files_) total += read.size();
      file->second = read_file(path, kMaxBufferBytes - std::min(total, kMaxBufferBytes));
      budget->add_file(file->second.size());
    }
    bytes = file->second;
    if (const std::string other = what_it_is(bytes); !other.empty()) throw Error(ErrorCode::bad_input, path, other);
  }
  if (source.byteLength > bytes.size())
    fail(where, fmt::format("should have {} bytes but has {}", source.byteLength, bytes.size()));
  return buffers_[index] = bytes.first(source.byteLength);
}

std::span<const uint8_t> Document::unpacked(size_t view, const std::string& where) {
  const file::Compression& packed = *model.bufferViews[view].compression;
  const auto [found, is_new] = unpacked_.try_emplace(view);
  if (!is_new) return found->second;
  const std::span<const uint8_t> all = buffer(packed.buffer, where);
  if (packed.byteOffset > all.size() || packed.byteLength > all.size() - packed.byteOffset)
    fail(where, fmt::format("its compressed part reaches beyond the {} bytes of its buffer", all.size()));
  found->second = decode_meshopt(*this, packed, all.subspan(packed.byteOffset, packed.byteLength), where);
  return found->second;
}

std::span<const uint8_t> Document::view_bytes(int view, uint64_t offset, uint64_t length, const std::string& where) {
  if (view < 0 || static_cast<size_t>(view) >= model.bufferViews.size())
    fail(where, fmt::format("names buffer view {}, but there are {}", view, model.bufferViews.size()));
  const file::BufferView& v = model.bufferViews[static_cast<size_t>(view)];
  const std::string view_where = at("bufferViews", static_cast<size_t>(view));
  std::span<const uint8_t> bytes;
  if (v.compression) {
    bytes = unpacked(static_cast<size_t>(view), view_where);
  } else {
    bytes = buffer(v.buffer, view_where);
    if (v.byteOffset > bytes.size() || v.byteLength > bytes.size() - v.byteOffset)
      fail(view_where, fmt::format("reaches beyond the {} bytes of its buffer", bytes.size()));
    bytes = bytes.subspan(v.byteOffset, v.byteLength);
  }
  if (offset > bytes.size() || length > bytes.size() - offset)
    fail(where, fmt::format("reaches beyond the {} bytes of its buffer view", bytes.size()));
  return bytes.subspan(offset, length);
}

Document read_document(std::span<const uint8_t> bytes, const std::string& name, const SceneFolder& folder,
                       MemoryBudget& budget, Warnings& warnings) {
  if (const std::string other = what_it_is(bytes); !other.empty()) throw Error(ErrorCode::bad_input, name, other);
  const Chunks chunks = split_container(bytes, name);
  JsonText text(json_text(chunks.json, name), name, JsonText::Repeated::last_counts);
  Document document;
  document.name = name;
  document.folder = folder;
  document.binary = chunks.binary;
  document.budget = &budget;
  budget.add_file(bytes.size());
  document.model = file::read_model(text.root(), name, warnings);
  return document;
}

}  // namespace kairos::gltf
