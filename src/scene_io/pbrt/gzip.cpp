#include "scene_io/pbrt/gzip.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include <kairos/error.h>

#include "base/file.h"

namespace kairos::pbrt {

namespace {

/// zlib's state, given back however one leaves.
struct Inflater {
  z_stream stream{};
  bool ready;
  Inflater() {
    constexpr int kLargestWindow = 15, kGzipOnly = 16;
    ready = inflateInit2(&stream, kLargestWindow + kGzipOnly) == Z_OK;
  }
  ~Inflater() {
    if (ready) inflateEnd(&stream);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

}  // namespace

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

std::vector<uint8_t> gunzip(std::string_view packed, uint64_t limit, const std::string& path) {
  Inflater inflater;
  if (!inflater.ready) throw Error(ErrorCode::io, path, "cannot be unpacked: zlib does not start");
  z_stream& stream = inflater.stream;
  // Grows with what really comes out: the length that the file claims is not to be trusted.
  constexpr size_t kFirst = 1 << 16, kMostAtOnce = 1 << 30;
  std::vector<uint8_t> out;
  size_t used = 0, taken = 0;
  for (;;) {
    if (used == out.size()) {
      if (used > limit) break;
      out.resize(std::min<uint64_t>(limit + 1, std::max(kFirst, out.size() * 2)));
    }
    if (stream.avail_in == 0) {
      const size_t piece = std::min(packed.size() - taken, kMostAtOnce);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));  // zlib does not write there
      stream.avail_in = static_cast<uInt>(piece);
      taken += piece;
    }
    const size_t room = std::min(out.size() - used, kMostAtOnce);
    stream.next_out = out.data() + used;
    stream.avail_out = static_cast<uInt>(room);
    const int status = inflate(&stream, Z_NO_FLUSH);
    used += room - stream.avail_out;
    if (status == Z_STREAM_END) {
      if (stream.avail_in == 0 && taken == packed.size()) break;
      if (inflateReset(&stream) != Z_OK) throw Error(ErrorCode::bad_input, path, "is no gzip file");  // several parts
      continue;
    }
    const bool cut_short = stream.avail_in == 0 && taken == packed.size() && stream.avail_out > 0;
    if (status == Z_MEM_ERROR) throw Error(ErrorCode::bad_input, path, "needs more memory than there is");
    if ((status != Z_OK && status != Z_BUF_ERROR) || cut_short)
      throw Error(ErrorCode::bad_input, path, cut_short ? "is a gzip file cut short" : "is no whole gzip file");
  }
  if (used > limit)
    throw Error(ErrorCode::bad_input, path,
                fmt::format("unpacks to more than {} bytes; unpack it first, or raise --memory-budget", limit));
  out.resize(used);
  return out;
}

std::vector<uint8_t> read_maybe_packed(const std::string& path, uint64_t limit, MemoryBudget& budget) {
  std::vector<uint8_t> bytes = read_file(path, limit);
  budget.add_file(bytes.size());
  if (!ends_with(path, ".gz")) return bytes;
  constexpr uint64_t kMostUnpacked = 64, kShare = 4;
  const uint64_t most = std::min(limit, kMostUnpacked * bytes.size() + budget.base() / kShare);
  std::vector<uint8_t> unpacked = gunzip({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, most, path);
  budget.charge(unpacked.size(), path);
  return unpacked;
}

}  // namespace kairos::pbrt
