#include "scene_io/gltf/document.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "scene_io/gltf/schema.h"

namespace kairos::gltf {

namespace {

using nlohmann::json;

// Deeper than any document that means something; parsers and destructors below recurse.
constexpr int kMaxJsonDepth = 64;
constexpr uint64_t kMaxJsonBytes = uint64_t{1} << 30;
constexpr uint64_t kMaxBufferBytes = uint64_t{1} << 34;
// What a file may grow to when decoded: see Document::charge.
constexpr uint64_t kMemoryFloor = uint64_t{256} << 20;
constexpr uint64_t kMemoryPerInputByte = 1024;

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
  if (word(4) != 2) fail(fmt::format("is GLB version {}; only version 2 is supported", word(4)));
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

/// One line without the library's own prefix.
std::string one_line(std::string text) {
  if (const size_t bracket = text.find("] "); text.rfind("[json", 0) == 0 && bracket != std::string::npos)
    text.erase(0, bracket + 2);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  constexpr size_t kLongest = 300;
  text.resize(std::min(text.size(), kLongest));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text;
}

json parse_json(std::span<const uint8_t> text, const std::string& name) {
  if (text.size() > kMaxJsonBytes) throw Error(ErrorCode::bad_input, name, "holds more than 1 GiB of JSON");
  const auto limit_depth = [&](int depth, json::parse_event_t, json&) {
    if (depth > kMaxJsonDepth)
      throw Error(ErrorCode::bad_input, name, fmt::format("nests JSON more than {} levels deep", kMaxJsonDepth));
    return true;
  };
  try {
    return json::parse(text.begin(), text.end(), limit_depth);
  } catch (const json::exception& e) {
    throw Error(ErrorCode::bad_input, name, "is not valid JSON: " + one_line(e.what()));
  }
}

void read_buffers(Document& document, const json& root, std::span<const uint8_t> binary, const std::string& folder) {
  std::map<std::string, size_t> files;  // path -> index in buffer_bytes: a file named often is read once
  uint64_t total = 0;
  const json buffers = root.value("buffers", json::array());
  document.buffer_bytes.reserve(buffers.size());  // spans point into it
  for (size_t i = 0; i < buffers.size(); ++i) {
    const json& buffer = buffers[i];
    const std::string where = at("buffers", i), place = document.name + ": " + where;
    if (!buffer.contains("byteLength")) document.fail(where, "has no byteLength");
    const uint64_t length = buffer["byteLength"].get<uint64_t>();
    std::span<const uint8_t> bytes;
    const std::string uri = buffer.value("uri", std::string());
    if (uri.empty()) {
      if (i != 0 || binary.empty()) document.fail(where, "has no uri, and the file has no binary chunk for it");
      bytes = binary;
    } else if (is_data_uri(uri)) {
      document.buffer_bytes.push_back(decode_data_uri(uri, place));
      bytes = document.buffer_bytes.back();
    } else {
      const std::string relative = percent_decode(uri);
      if (folder.empty())
        document.fail(where, "names the file '" + printable(relative) + "', but only this one is read");
      const std::string path = resolve_inside(folder, relative, place);
      const auto [known, is_new] = files.emplace(path, document.buffer_bytes.size());
      if (is_new) document.buffer_bytes.push_back(read_file(path, kMaxBufferBytes - total));
      bytes = document.buffer_bytes[known->second];
      if (is_new) total += bytes.size();
    }
    if (length > bytes.size())
      document.fail(where, fmt::format("should have {} bytes but has {}", length, bytes.size()));
    document.buffers.push_back(bytes.first(length));
  }
}

void read_image_sources(Document& document, const json& root, const std::string& folder) {
  const json images = root.value("images", json::array());
  for (size_t i = 0; i < images.size(); ++i) {
    const std::string uri = images[i].value("uri", std::string());
    const std::string place = document.name + ": " + at("images", i);
    ImageSource& image = document.images.emplace_back();
    if (is_data_uri(uri)) {
      image = {place, true, -1, decode_data_uri(uri, place)};
    } else if (uri.empty() && images[i].contains("bufferView")) {
      image = {place, true, images[i]["bufferView"].get<int>(), {}};
    } else if (!uri.empty() && !folder.empty()) {
      image.name = resolve_inside(folder, percent_decode(uri), place);
    }
  }
}

/// Has tinygltf fill its structs. What it does beyond syntax is kept from it: it gets neither buffers nor images,
/// and its demand that index accessors have a buffer view (those of Draco do not) is met by a stand-in.
void fill_model(Document& document, json& root) {
  root.erase("buffers");
  root.erase("images");
  json& views = root["bufferViews"];
  if (views.is_null()) views = json::array();
  const size_t stand_in = views.size();
  views.push_back({{"buffer", 0}, {"byteLength", 1}});
  if (const auto accessors = root.find("accessors"); accessors != root.end())
    for (size_t i = 0; i < accessors->size(); ++i) {
      json& view = (*accessors)[i]["bufferView"];
      if (view.is_null())
        view = stand_in;
      else if (view.get<uint64_t>() >= stand_in)
        document.fail(at("accessors", i), fmt::format("names buffer view {}, but there are {}", view.dump(), stand_in));
    }

  tinygltf::TinyGLTF reader;
  const std::string text = root.dump();
  std::string errors, ignored;
  bool ok = false;
  try {
    ok = reader.LoadASCIIFromString(&document.model, &errors, &ignored, text.data(),
                                    static_cast<unsigned int>(text.size()), "");
  } catch (const std::exception& e) {
    errors = e.what();
  }
  if (!ok) throw Error(ErrorCode::bad_input, document.name, "is not sound glTF: " + one_line(errors));
  document.model.bufferViews.pop_back();
  for (tinygltf::Accessor& accessor : document.model.accessors)
    if (accessor.bufferView == static_cast<int>(stand_in)) accessor.bufferView = -1;
  if (document.model.asset.version.rfind("2.", 0) != 0)
    document.fail("asset.version",
                  "is '" + printable(document.model.asset.version) + "'; only glTF 2 is supported, convert the file");
}

}  // namespace

std::string at(const char* array, size_t index) { return fmt::format("{}[{}]", array, index); }

void Document::fail(const std::string& where, const std::string& message) const {
  throw Error(ErrorCode::bad_input, name + ": " + where, message);
}

void Document::charge(uint64_t bytes, const std::string& where) {
  if (bytes > memory_left) fail(where, "the file would need an absurd amount of memory for its size");
  memory_left -= bytes;
}

Document read_document(std::span<const uint8_t> bytes, const std::string& name, const std::string& folder) {
  const Chunks chunks = split_container(bytes, name);
  json root = parse_json(chunks.json, name);
  check_schema(root, name);
  Document document;
  document.name = name;
  read_buffers(document, root, chunks.binary, folder);
  read_image_sources(document, root, folder);
  uint64_t input = bytes.size();
  for (const auto& buffer : document.buffer_bytes) input += buffer.size();
  document.memory_left = kMemoryFloor + kMemoryPerInputByte * input;
  fill_model(document, root);
  return document;
}

}  // namespace kairos::gltf
