#include "scene_io/gltf/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <kairos/printable.h>

namespace kairos::gltf {

namespace {

void check_numbers(const Document& document, const file::Compression& packed, const std::string& where) {
  const uint64_t stride = packed.byteStride;
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) document.fail(where, "its compression " + what);
  };
  constexpr uint64_t kWidest = 256, kMostElements = uint64_t{1} << 32;
  require(packed.count < kMostElements, fmt::format("has {} elements", packed.count));
  if (packed.mode == "ATTRIBUTES") {
    require(stride > 0 && stride <= kWidest && stride % 4 == 0,
            fmt::format("has a byteStride of {}, and not a multiple of 4 up to 256", stride));
  } else if (packed.mode == "TRIANGLES" || packed.mode == "INDICES") {
    require(stride == 2 || stride == 4, fmt::format("has indices of {} bytes, and not of 2 or 4", stride));
    require(packed.mode == "INDICES" || packed.count % 3 == 0,
            fmt::format("has {} indices of triangles, which is no multiple of 3", packed.count));
    require(packed.filter == "NONE", "has a filter, which indices have not");
  } else {
    require(false, "has the unknown mode '" + printable(packed.mode) + "'");
  }
  if (packed.filter == "OCTAHEDRAL")
    require(stride == 4 || stride == 8, "is OCTAHEDRAL, and has not 4 or 8 bytes an element");
  else if (packed.filter == "QUATERNION")
    require(stride == 8, "is QUATERNION, and has not 8 bytes an element");
  else
    require(packed.filter == "NONE" || packed.filter == "EXPONENTIAL",
            "has the filter '" + printable(packed.filter) + "', which is not read; compress the file without it");
}

}  // namespace

std::vector<uint8_t> decode_meshopt(Document& document, const file::Compression& packed, std::span<const uint8_t> bytes,
                                    const std::string& where) {
  check_numbers(document, packed, where);
  const size_t count = packed.count, stride = packed.byteStride;
  document.charge(packed.count * packed.byteStride, where);
  std::vector<uint8_t> result(count * stride);
  int failure = 0;
  if (packed.mode == "ATTRIBUTES")
    failure = meshopt_decodeVertexBuffer(result.data(), count, stride, bytes.data(), bytes.size());
  else if (packed.mode == "TRIANGLES")
    failure = meshopt_decodeIndexBuffer(result.data(), count, stride, bytes.data(), bytes.size());
  else
    failure = meshopt_decodeIndexSequence(result.data(), count, stride, bytes.data(), bytes.size());
  if (failure != 0)
    document.fail(where,
                  "its compressed data is broken, or of a newer form than is read; decompress the file, for "
                  "example with gltf-transform or gltfpack without -c");
  if (packed.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(result.data(), count, stride);
  if (packed.filter == "QUATERNION") meshopt_decodeFilterQuat(result.data(), count, stride);
  if (packed.filter == "EXPONENTIAL") meshopt_decodeFilterExp(result.data(), count, stride);
  return result;
}

}  // namespace kairos::gltf
