// numpy's array files of events, and reading arrays.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "event_io/label_columns.h"

namespace kairos {

/// Metavision's event, of 16 bytes; numpy names the two that are left empty.
inline constexpr const char* kNpyEvents = "[('x','<u2'),('y','<u2'),('p','<i2'),('','|V2'),('t','<i8')]";

/// What an array holds.
struct NpyArray {
  std::string descr;  ///< as it stands there, without spaces
  uint64_t count = 0;
  std::span<const uint8_t> data;  ///< at least count times what the caller takes an item to be: see parse_npy
};
/// Throws Error(bad_input, place) for what is none, is not one-dimensional, or has fewer bytes than
/// count * item_size(descr). item_size of unknown descriptions is 0.
NpyArray parse_npy(const std::string& place, std::span<const uint8_t> bytes);
size_t npy_item_size(const std::string& descr);

/// Where the labels of the events in `path` stand: NAME.labels.npy beside NAME.npy.
std::string npy_labels_path(const std::string& path);
/// How numpy describes one label of that file.
std::string npy_labels_descr();
/// Labels of events, one after the other. Throws as parse_npy, and where they are not `count`.
class NpyLabels {
 public:
  NpyLabels() = default;  ///< none
  /// Reads the bytes, which must outlive it.
  NpyLabels(const std::string& place, std::span<const uint8_t> bytes, uint64_t count);
  bool has() const { return !data_.empty(); }
  KindLabel at(uint64_t index) const;

 private:
  std::span<const uint8_t> data_;
};

}  // namespace kairos
