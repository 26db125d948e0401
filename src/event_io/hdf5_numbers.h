// Lists of numbers in HDF5 files, of which some grow while they are written.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "event_io/event_format.h"
#include "event_io/hdf5_file.h"
#include "event_io/label_columns.h"

namespace kairos {

/// The library's native type of a number. Truth values are bytes.
template <class Number>
hid_t hdf5_type() {
  if constexpr (std::is_same_v<Number, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, int64_t>) return H5T_NATIVE_INT64;
  switch (sizeof(Number)) {
    case 1:
      return H5T_NATIVE_UINT8;
    case 2:
      return H5T_NATIVE_UINT16;
    case 4:
      return H5T_NATIVE_UINT32;
    default:
      return H5T_NATIVE_UINT64;
  }
}

/// A growing data set, compressed.
class NumberSet {
 public:
  static constexpr hsize_t kChunk = 65536;  // numbers that are compressed together

  /// A set for numbers as this one is, whose value does not matter.
  template <class Number>
  NumberSet(hid_t file, const char* name, Number /*like*/, const std::string& path)
      : path_(path),
        type_(hdf5_type<Number>()),
        size_(sizeof(Number)),
        set_(make_set(file, name, type_, packed(path), path)) {}

  /// Of the type that the set was made with.
  template <class Number>
  void put(Number value) {
    const auto* const bytes = reinterpret_cast<const uint8_t*>(&value);
    block_.insert(block_.end(), bytes, bytes + sizeof value);
    if (block_.size() == kChunk * size_) flush();
  }
  void flush() {
    if (block_.empty()) return;
    const hsize_t begin = written_, count = block_.size() / size_, end = begin + count;
    if (H5Dset_extent(set_, &end) < 0) refuse();
    const Hdf5Handle place(H5Dget_space(set_), H5Sclose, path_),
        memory(H5Screate_simple(1, &count, nullptr), H5Sclose, path_);
    if (H5Sselect_hyperslab(place, H5S_SELECT_SET, &begin, nullptr, &count, nullptr) < 0 ||
        H5Dwrite(set_, type_, memory, place, H5P_DEFAULT, block_.data()) < 0)
      refuse();
    written_ = end;
    block_.clear();
  }

 private:
  [[noreturn]] void refuse() const { throw Error(ErrorCode::io, path_, "cannot be written: the HDF5 library refused"); }
  static Hdf5Handle packed(const std::string& path) {
    Hdf5Handle how = growing_set(kChunk, path);
    H5Pset_shuffle(how);
    H5Pset_deflate(how, 1);
    return how;
  }

  std::string path_;
  hid_t type_;
  size_t size_;
  Hdf5Handle set_;
  std::vector<uint8_t> block_;
  hsize_t written_ = 0;
};

/// Reads stretches of a data set of numbers. Throws Error(bad_input) for what is none.
class NumberReader {
 public:
  NumberReader(hid_t file, const char* name, const std::string& path)
      : path_(path + ": " + name), set_(open(file, name, path_)), space_(H5Dget_space(set_), H5Sclose, path_) {
    hsize_t size = 0;
    if (H5Sget_simple_extent_ndims(space_) != 1 || H5Sget_simple_extent_dims(space_, &size, nullptr) < 0)
      throw Error(ErrorCode::bad_input, path_, "is no list of numbers");
    size_ = size;
  }
  uint64_t size() const { return size_; }
  /// As many as `out` has room for, which are there.
  template <class Number>
  void read(uint64_t begin, std::vector<Number>& out) {
    const hsize_t from = begin, count = out.size();
    const Hdf5Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, path_);
    if (H5Sselect_hyperslab(space_, H5S_SELECT_SET, &from, nullptr, &count, nullptr) < 0 ||
        H5Dread(set_, hdf5_type<Number>(), memory, space_, H5P_DEFAULT, out.data()) < 0)
      throw Error(ErrorCode::bad_input, path_, "cannot be read: broken, or compressed in a way that needs a plugin");
  }

 private:
  static Hdf5Handle open(hid_t file, const char* name, const std::string& place) {
    const hid_t id = H5Dopen2(file, name, H5P_DEFAULT);
    if (id < 0) throw Error(ErrorCode::bad_input, place, "is not there, or no data set");
    return {id, H5Dclose, place};
  }

  std::string path_;
  Hdf5Handle set_, space_;
  uint64_t size_ = 0;
};

/// What made pixels fire, in a group that others' files of the same layout do not have.
class LabelSets {
 public:
  LabelSets(hid_t file, const std::string& path) {
    KindLabel like;
    kind_label_fields(
        [&](const char* name, auto& field) {
          sets_.push_back(std::make_unique<NumberSet>(file, (std::string(kGroup) + name).c_str(), field, path));
        },
        like);
  }
  void put(const Event& event, const EventLabel& label) {
    KindLabel all{label, static_cast<uint8_t>(event.kind)};
    auto set = sets_.begin();
    kind_label_fields([&](const char* /*name*/, auto& field) { (*set++)->put(field); }, all);
  }
  void flush() {
    for (const auto& set : sets_) set->flush();
  }

  static constexpr const char* kGroup = "labels/";

 private:
  std::vector<std::unique_ptr<NumberSet>> sets_;
};

/// Reads them again, where a file has them.
class LabelReader {
 public:
  /// count: of the file's events. Throws Error(bad_input) where labels are as many as not.
  LabelReader(hid_t file, const std::string& path, uint64_t count) {
    if (H5Lexists(file, "labels", H5P_DEFAULT) <= 0) return;
    KindLabel like;
    kind_label_fields(
        [&](const char* name, auto& /*field*/) {
          readers_.push_back(
              std::make_unique<NumberReader>(file, (std::string(LabelSets::kGroup) + name).c_str(), path));
          if (readers_.back()->size() != count)
            throw Error(ErrorCode::bad_input, path, "has labels of another number than its events");
        },
        like);
  }
  bool has() const { return !readers_.empty(); }
  /// Of the events from `begin` on.
  void read(uint64_t begin, uint64_t count) {
    columns_.resize(readers_.size());
    for (size_t i = 0; i < readers_.size(); ++i) {
      columns_[i].resize(count);
      readers_[i]->read(begin, columns_[i]);
    }
  }
  /// Of those that were read.
  KindLabel at(uint64_t index) const {
    KindLabel all;
    auto column = columns_.begin();
    kind_label_fields([&](const char* /*name*/, auto& field) { set_field(field, (*column++)[index]); }, all);
    return all;
  }

 private:
  std::vector<std::unique_ptr<NumberReader>> readers_;
  std::vector<std::vector<double>> columns_;  // [field][event], of those that were read
};

}  // namespace kairos
