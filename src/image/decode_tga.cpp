// TGA: palettes, greys and colours, plain or run-length encoded.
#include <array>
#include <cstring>

#include <kairos/error.h>

#include "image/picture_formats.h"

namespace kairos {

namespace {

constexpr size_t kHeaderBytes = 18;
constexpr int kPalette = 1, kColour = 2, kGrey = 3, kEncoded = 8;  // kinds, and what is added to one

struct TgaHeader {
  int kind = 0;
  bool encoded = false, from_top = false, from_right = false;
  size_t name_bytes = 0, first_entry = 0, entries = 0;
  int entry_bits = 0, texel_bits = 0;
  int width = 0, height = 0;

  explicit TgaHeader(std::span<const uint8_t> bytes) {
    const auto word = [&](size_t i) { return bytes[i] | bytes[i + 1] << 8; };
    name_bytes = bytes[0];
    encoded = (bytes[2] & kEncoded) != 0;
    kind = bytes[2] & ~kEncoded;
    first_entry = static_cast<size_t>(word(3));
    entries = bytes[1] == 1 ? static_cast<size_t>(word(5)) : 0;
    entry_bits = bytes[7];
    width = word(12);
    height = word(14);
    texel_bits = bytes[16];
    from_right = (bytes[17] & 0x10) != 0;
    from_top = (bytes[17] & 0x20) != 0;
  }

  size_t entry_bytes() const { return static_cast<size_t>(entry_bits + 7) / 8; }
  size_t texel_bytes() const { return static_cast<size_t>(texel_bits + 7) / 8; }
  size_t texels_at() const { return kHeaderBytes + name_bytes + entries * entry_bytes(); }
};

bool is_colour_depth(int bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; }

/// There is no signature: the header has to make sense.
bool is_tga(std::span<const uint8_t> bytes) {
  if (bytes.size() < kHeaderBytes || bytes[1] > 1) return false;
  const TgaHeader header(bytes);
  if (header.width == 0 || header.height == 0) return false;
  switch (header.kind) {
    case kPalette:
      return bytes[1] == 1 && header.entries > 0 && is_colour_depth(header.entry_bits) &&
             (header.texel_bits == 8 || header.texel_bits == 16);
    case kColour:
      return is_colour_depth(header.texel_bits);
    case kGrey:
      return header.texel_bits == 8 || header.texel_bits == 16;
    default:
      return false;
  }
}

PictureCost tga_cost(std::span<const uint8_t> bytes, const std::string& place) {
  const TgaHeader header(bytes);
  const PictureCost cost = plain_cost(header.width, header.height, kPictureChannels, place);
  constexpr size_t kMostOfRun = 128;
  const size_t texels = texel_count(cost), runs = (texels + kMostOfRun - 1) / kMostOfRun;
  const size_t least = header.encoded ? runs * (1 + header.texel_bytes()) : texels * header.texel_bytes();
  if (bytes.size() < header.texels_at() || bytes.size() - header.texels_at() < least)
    fail_damaged(place, "too short for its size");
  return cost;
}

using Code = std::array<uint8_t, kPictureChannels>;

/// `bytes`: blue, green, red, perhaps alpha; or five bits of each of red, green and blue.
Code colour(const uint8_t* bytes, int bits) {
  if (bits >= 24) return {bytes[2], bytes[1], bytes[0], bits == 32 ? bytes[3] : uint8_t{255}};
  const unsigned word = bytes[0] | static_cast<unsigned>(bytes[1]) << 8;
  const auto five = [&](unsigned shift) { return static_cast<uint8_t>((word >> shift & 31) * 255 / 31); };
  return {five(10), five(5), five(0), 255};
}

class TgaReader {
 public:
  TgaReader(std::span<const uint8_t> bytes, const std::string& place)
      : header_(bytes), place_(place), rest_(bytes.subspan(header_.texels_at())) {
    // Other kinds may have a palette that nothing uses, with entries of any size: texels_at() steps over it.
    if (header_.kind != kPalette) return;
    const uint8_t* const entries = bytes.data() + kHeaderBytes + header_.name_bytes;
    for (size_t i = 0; i < header_.entries; ++i)
      palette_.push_back(colour(entries + i * header_.entry_bytes(), header_.entry_bits));
  }

  /// In the file's order.
  Code next() {
    if (!header_.encoded) return take_texel();
    if (left_ == 0) {
      const uint8_t run = take(1)[0];
      left_ = (run & 0x7f) + 1;
      repeats_ = (run & 0x80) != 0;
      if (repeats_) texel_ = take_texel();
    }
    --left_;
    return repeats_ ? texel_ : take_texel();
  }

 private:
  std::span<const uint8_t> take(size_t count) {
    if (count > rest_.size()) fail_damaged(place_, "cut short");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  Code take_texel() {
    const uint8_t* const bytes = take(header_.texel_bytes()).data();
    if (header_.kind == kColour) return colour(bytes, header_.texel_bits);
    if (header_.kind == kGrey)
      return {bytes[0], bytes[0], bytes[0], header_.texel_bits == 16 ? bytes[1] : uint8_t{255}};
    const size_t index = bytes[0] | (header_.texel_bits == 16 ? size_t{bytes[1]} << 8 : 0);
    if (index < header_.first_entry || index - header_.first_entry >= palette_.size())
      fail_damaged(place_, "a colour that its palette does not have");
    return palette_[index - header_.first_entry];
  }

  const TgaHeader header_;
  const std::string& place_;
  std::span<const uint8_t> rest_;
  std::vector<Code> palette_;
  int left_ = 0;  // of the run
  bool repeats_ = false;
  Code texel_{};
};

Pixels decode_tga(std::span<const uint8_t> bytes, const std::string& place) {
  const PictureCost cost = tga_cost(bytes, place);
  const TgaHeader header(bytes);
  TgaReader reader(bytes, place);
  Pixels pixels{cost.width, cost.height, std::vector<uint8_t>(texel_count(cost) * kPictureChannels), {}};
  for (int row = 0; row < cost.height; ++row)
    for (int column = 0; column < cost.width; ++column) {
      const int y = header.from_top ? row : cost.height - 1 - row;
      const int x = header.from_right ? cost.width - 1 - column : column;
      const Code code = reader.next();
      std::memcpy(&pixels.codes[(static_cast<size_t>(y) * static_cast<size_t>(cost.width) + static_cast<size_t>(x)) *
                                kPictureChannels],
                  code.data(), code.size());
    }
  return pixels;
}

}  // namespace

const PictureFormat kTga{is_tga, tga_cost, decode_tga};

}  // namespace kairos
