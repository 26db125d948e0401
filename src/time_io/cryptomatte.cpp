#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <kairos/object_layers.h>

#include "time_io/murmur_hash.h"

namespace kairos {

uint32_t murmur3_32(std::string_view text) {
  const auto mixed = [](uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; };
  uint32_t hash = 0;
  size_t at = 0;
  for (; at + 4 <= text.size(); at += 4) {
    uint32_t block = 0;
    for (size_t i = 0; i < 4; ++i) block |= uint32_t{static_cast<uint8_t>(text[at + i])} << (8 * i);
    hash = std::rotl(hash ^ mixed(block), 13) * 5 + 0xe6546b64u;
  }
  uint32_t rest = 0;
  for (size_t i = 0; at + i < text.size(); ++i) rest |= uint32_t{static_cast<uint8_t>(text[at + i])} << (8 * i);
  hash ^= mixed(rest);
  hash ^= static_cast<uint32_t>(text.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

namespace {

/// Exponents of zeros and denormals, and of infinities and what is no number, become others.
uint32_t usable_bits(uint32_t hash) {
  const uint32_t exponent = hash >> 23 & 0xffu;
  return exponent == 0 || exponent == 0xff ? hash ^ 1u << 23 : hash;
}

}  // namespace

float cryptomatte_id(std::string_view name) { return std::bit_cast<float>(usable_bits(murmur3_32(name))); }

void add_cryptomatte(Image& image, const ExposedObjects& objects, const TimeFrame& frame, MatteKind kind, int ranks) {
  const std::string layer = kind == MatteKind::object ? "CryptoObject" : "CryptoMaterial";
  const auto named = [](const std::string& name) { return name.empty() ? "unnamed" : name; };
  std::vector<std::string> names;  // [mesh]
  for (const TimeFrame::Object& object : frame.objects)
    names.push_back(named(kind == MatteKind::object                  ? object.name
                          : object.material < frame.materials.size() ? frame.materials[object.material]
                                                                     : ""));
  std::vector<float> ids;
  nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
  for (const std::string& name : names) {
    ids.push_back(cryptomatte_id(name));
    manifest[name] = fmt::format("{:08x}", usable_bits(murmur3_32(name)));
  }
  const std::string key = "cryptomatte/" + fmt::format("{:08x}", murmur3_32(layer)).substr(0, 7) + "/";
  image.attributes.push_back({key + "name", layer});
  image.attributes.push_back({key + "hash", std::string("MurmurHash3_32")});
  image.attributes.push_back({key + "conversion", std::string("uint32_to_float32")});
  image.attributes.push_back(
      {key + "manifest", manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});

  const size_t pixels = objects.first.size() - 1, first = image.channels.size();
  for (int rank = 0; rank < ranks; ++rank)
    for (const char* part : rank % 2 == 0 ? std::array{"r", "g"} : std::array{"b", "a"})
      image.channels.push_back(
          {fmt::format("{}{:02}.{}", layer, rank / 2, part), Channel::Storage::exact, std::vector<float>(pixels)});
  struct Matte {
    float id = 0, coverage = 0;
  };
  std::vector<Matte> mattes;
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    mattes.clear();
    for (const SeenObject& object : objects.of(pixel)) {
      if (!(object.coverage > 0)) continue;
      const float id = ids[object.mesh];
      const auto known = std::find_if(mattes.begin(), mattes.end(), [&](const Matte& matte) { return matte.id == id; });
      if (known == mattes.end())
        mattes.push_back({id, object.coverage});
      else
        known->coverage += object.coverage;
    }
    std::stable_sort(mattes.begin(), mattes.end(),
                     [](const Matte& a, const Matte& b) { return a.coverage > b.coverage; });
    for (size_t rank = 0; rank < std::min(mattes.size(), static_cast<size_t>(ranks)); ++rank) {
      image.channels[first + 2 * rank].values[pixel] = mattes[rank].id;
      image.channels[first + 2 * rank + 1].values[pixel] = mattes[rank].coverage;
    }
  }
}

}  // namespace kairos
