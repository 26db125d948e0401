// HDR (Radiance): three mantissas with a common exponent, plain, repeated, or run-length encoded by components.
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include <kairos/error.h>

#include "image/picture_formats.h"

namespace kairos {

namespace {

constexpr size_t kRgbe = 4;                                 // bytes of a texel
constexpr size_t kLongestRun = 127, kLeastOfRun = 2;        // texels that a run stands for; bytes that it takes
constexpr size_t kLeastEncoded = 8, kMostEncoded = 0x7fff;  // widths of rows that may be encoded by components

bool is_hdr(std::span<const uint8_t> bytes) {
  for (const std::string_view signature : {"#?RADIANCE\n", "#?RGBE\n"})
    if (bytes.size() >= signature.size() && std::memcmp(bytes.data(), signature.data(), signature.size()) == 0)
      return true;
  return false;
}

struct HdrHeader {
  PictureCost cost;
  size_t size = 0;  ///< bytes
};

int read_size(std::string_view& line, std::string_view axis, const std::string& place) {
  if (line.substr(0, axis.size()) != axis)
    throw Error(ErrorCode::bad_input, place, "is an HDR picture that does not begin with '-Y HEIGHT +X WIDTH'");
  line.remove_prefix(axis.size());
  int size = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), size);
  if (error != std::errc() || size < 1) fail_damaged(place, "no size");
  line.remove_prefix(static_cast<size_t>(end - line.data()));
  return size;
}

HdrHeader read_header(std::span<const uint8_t> bytes, const std::string& place) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  size_t begin = 0;
  bool is_rgbe = false;
  const auto next_line = [&] {
    const size_t end = text.find('\n', begin);
    if (end == text.npos) fail_damaged(place, "cut short");
    std::string_view line = text.substr(begin, end - begin);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    begin = end + 1;
    return line;
  };
  for (std::string_view line = next_line(); !line.empty(); line = next_line())
    is_rgbe = is_rgbe || line == "FORMAT=32-bit_rle_rgbe";
  if (!is_rgbe) throw Error(ErrorCode::bad_input, place, "is an HDR picture of another kind than 32-bit_rle_rgbe");
  std::string_view line = next_line();
  const int height = read_size(line, "-Y ", place), width = read_size(line, " +X ", place);
  HdrHeader header{plain_cost(width, height, kPictureChannels * sizeof(float), place), begin};
  // Encoded rows have at least the runs that they would take if they were of one colour.
  const uint64_t runs = (static_cast<uint64_t>(width) + kLongestRun - 1) / kLongestRun;
  const uint64_t least = static_cast<uint64_t>(height) * kRgbe * (1 + kLeastOfRun * runs);
  const bool is_encoded = bytes.size() - begin >= 2 && bytes[begin] == 2 && bytes[begin + 1] == 2;
  if (is_encoded && bytes.size() - begin < least) fail_damaged(place, "too short for its size");
  return header;
}

class HdrReader {
 public:
  HdrReader(std::span<const uint8_t> rest, const std::string& place) : rest_(rest), place_(place) {}

  void read_row(std::span<uint8_t> row) {
    const size_t width = row.size() / kRgbe;
    const bool may_be_encoded = width >= kLeastEncoded && width <= kMostEncoded;
    constexpr uint8_t kMark = 2;  // two of them, and the row's width: no texel has it so
    if (may_be_encoded && rest_.size() >= kRgbe && rest_[0] == kMark && rest_[1] == kMark && rest_[2] < 0x80) {
      const auto start = take(kRgbe);
      if ((size_t{start[2]} << 8 | start[3]) != width)
        fail_damaged(place_, "a row of another length than its header says");
      for (size_t component = 0; component < kRgbe; ++component) read_component(row, component);
      return;
    }
    read_plain(row);
  }

 private:
  std::span<const uint8_t> take(size_t count) {
    if (count > rest_.size()) fail_damaged(place_, "cut short");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  void read_component(std::span<uint8_t> row, size_t component) {
    constexpr uint8_t kRun = 128;  // more than that: so many more times the next byte
    const size_t width = row.size() / kRgbe;
    for (size_t x = 0; x < width;) {
      const uint8_t code = take(1)[0];
      const bool is_run = code > kRun;
      const size_t count = is_run ? code - kRun : code;
      if (count == 0 || count > width - x) fail_damaged(place_, "a run that does not fit its row");
      const auto values = take(is_run ? 1 : count);
      for (size_t i = 0; i < count; ++i, ++x) row[x * kRgbe + component] = values[is_run ? 0 : i];
    }
  }

  /// Texel by texel; one of 1, 1, 1 and a count repeats the one before, and the next such goes on with higher digits.
  void read_plain(std::span<uint8_t> row) {
    const size_t width = row.size() / kRgbe;
    unsigned shift = 0;
    for (size_t x = 0; x < width;) {
      const auto texel = take(kRgbe);
      if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
        std::memcpy(&row[x * kRgbe], texel.data(), kRgbe);
        ++x;
        shift = 0;
        continue;
      }
      constexpr unsigned kMostShift = 16;
      const size_t count = shift > kMostShift ? 0 : size_t{texel[3]} << shift;
      if (x == 0 || count == 0 || count > width - x) fail_damaged(place_, "a repetition that does not fit its row");
      for (size_t i = 0; i < count; ++i, ++x) std::memcpy(&row[x * kRgbe], &row[(x - 1) * kRgbe], kRgbe);
      shift += 8;
    }
  }

  std::span<const uint8_t> rest_;
  const std::string& place_;
};

PictureCost hdr_cost(std::span<const uint8_t> bytes, const std::string& place) {
  return read_header(bytes, place).cost;
}

Pixels decode_hdr(std::span<const uint8_t> bytes, const std::string& place) {
  const HdrHeader header = read_header(bytes, place);
  HdrReader reader(bytes.subspan(header.size), place);
  Pixels pixels{
      header.cost.width, header.cost.height, {}, std::vector<float>(texel_count(header.cost) * kPictureChannels)};
  std::vector<uint8_t> row(static_cast<size_t>(header.cost.width) * kRgbe);
  float* out = pixels.values.data();
  for (int y = 0; y < header.cost.height; ++y) {
    reader.read_row(row);
    for (size_t i = 0; i < row.size(); i += kRgbe, out += kPictureChannels) {
      constexpr int kBias = 128 + 8;  // of the exponent, and the mantissas' digits
      const float unit = row[i + 3] == 0 ? 0 : std::ldexp(1.0f, row[i + 3] - kBias);
      for (size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(row[i + c]) * unit;
      out[3] = 1;
    }
  }
  return pixels;
}

}  // namespace

const PictureFormat kHdr{is_hdr, hdr_cost, decode_hdr};

}  // namespace kairos
