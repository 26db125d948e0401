// numpy's archives (.npz): a ZIP file whose members are arrays.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/atomic_file.h"
#include "base/little_endian.h"
#include "base/scratch_file.h"

namespace kairos {

/// Of an array's file, always of kNpyHeader bytes (of long descriptions twice as many), so that it can be written again
/// when its length is known.
inline constexpr size_t kNpyHeader = 128;
/// descr: as numpy writes it, such as '<i8' with its quotes. Of `count` items in one dimension, or, where there is a
/// width, in as many rows of so many.
std::string npy_header(const std::string& descr, uint64_t count, uint64_t width = 0);
/// Of any shape; none: a single item.
std::string npy_header(const std::string& descr, std::span<const uint64_t> shape);

/// Written member by member, nothing compressed. All have 64-bit sizes.
class NpzFile {
 public:
  /// This and all else throws Error(io) when the file cannot be written.
  explicit NpzFile(const std::string& path) : file_(path) {}

  /// body: writes the `size` bytes of which crc is the checksum.
  void add(const std::string& name, uint64_t size, uint32_t crc, const std::function<void(AtomicFile& out)>& body);
  /// An array of any shape, whose items are `bytes`.
  void add_array(const std::string& name, const std::string& descr, std::span<const uint64_t> shape,
                 std::span<const uint8_t> bytes);
  void finish();

 private:
  struct Member {
    std::string name;
    uint64_t size, offset;
    uint32_t crc;
  };

  void put_common(const std::string& name, uint32_t crc, uint16_t extra);
  void put_name(const std::string& name) { bytes_.insert(bytes_.end(), name.begin(), name.end()); }
  void put_sizes(uint64_t size, const uint64_t* offset);
  void write() { file_.write(bytes_.data(), bytes_.size()); }

  AtomicFile file_;
  std::vector<Member> members_;
  std::vector<uint8_t> bytes_;
};

/// Appends the bytes of a number, whole or not.
template <class Value>
void put_item(std::vector<uint8_t>& bytes, Value value) {
  if constexpr (std::is_floating_point_v<Value>)
    put_little(bytes, std::bit_cast<std::conditional_t<sizeof(Value) == 4, uint32_t, uint64_t>>(value));
  else
    put_little(bytes, value);
}

/// A file of one array, whose length is known when it is complete.
class NpyFile {
 public:
  /// descr, width: npy_header's. This and all else throws Error(io) when the file cannot be written.
  NpyFile(const std::string& path, std::string descr, uint64_t width = 0);

  /// `items` more, of which these are the bytes.
  void write(std::span<const uint8_t> bytes, uint64_t items);
  void finish();

 private:
  void write_header();

  AtomicFile file_;
  std::string descr_;
  uint64_t width_, count_ = 0;
};

/// An array whose length is known when it is complete: until then it lies beside the archive.
class NpyColumn {
 public:
  /// path: the archive's. descr, width: npy_header's.
  NpyColumn(const std::string& path, std::string name, std::string descr, uint64_t width = 0);

  /// Of the type that descr says.
  template <class Value>
  void put(Value value) {
    put_item(bytes_, value);
    ++count_;
  }
  /// Puts what is in memory into the file beside the archive.
  void flush();
  /// All that was put.
  void add_to(NpzFile& npz);

 private:
  ScratchFile file_;
  std::string name_, descr_;
  uint64_t width_;
  std::vector<uint8_t> bytes_;
  uint64_t count_ = 0, size_ = 0;
};

}  // namespace kairos
