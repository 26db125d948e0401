// What writers and readers of HDF5 files share.
#pragma once

#include <string>

#include <hdf5.h>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "base/scratch_file.h"

namespace kairos {

/// An HDF5 identifier, closed with what it is of.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t), const std::string& path) : id_(id), close_(close) {
    if (id_ < 0) throw Error(ErrorCode::io, path, "the HDF5 library refused it");
  }
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): the library's functions take it

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// The library prints what goes wrong unless told not to; we say it in a line of our own.
inline void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// How a data set grows: in chunks of so many elements, without a date, so that files of the same events are the same.
inline Hdf5Handle growing_set(hsize_t chunk, const std::string& path) {
  Hdf5Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path);
  H5Pset_chunk(how, 1, &chunk);
  H5Pset_obj_track_times(how, false);
  return how;
}

/// Makes a data set of no elements yet, and the groups above it. how: as growing_set makes it.
inline Hdf5Handle make_set(hid_t file, const char* name, hid_t type, const Hdf5Handle& how, const std::string& path) {
  const hsize_t none = 0, most = H5S_UNLIMITED;
  const Hdf5Handle space(H5Screate_simple(1, &none, &most), H5Sclose, path),
      links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, path);
  H5Pset_create_intermediate_group(links, 1);
  return {H5Dcreate2(file, name, type, space, links, how, H5P_DEFAULT), H5Dclose, path};
}

/// A file that is being written, there whole or not at all. The library writes beside it, without a name.
class Hdf5Output {
 public:
  explicit Hdf5Output(const std::string& path)
      : path_(path),
        target_(path),
        scratch_(path, [&](const std::string& name) { id_ = create(name); }),
        file_(id_, H5Fclose, path) {}

  operator hid_t() const { return file_; }  // NOLINT(google-explicit-constructor)

  void finish() {
    if (H5Fflush(file_, H5F_SCOPE_GLOBAL) < 0)
      throw Error(ErrorCode::io, path_, "the HDF5 library refused to write it");
    scratch_.read([&](const char* block, size_t size) { target_.write(block, size); });
    target_.commit();
  }

 private:
  static hid_t create(const std::string& name) {
    silence_hdf5();
    return H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  }

  std::string path_;
  AtomicFile target_;
  hid_t id_ = -1;
  ScratchFile scratch_;
  Hdf5Handle file_;
};

}  // namespace kairos
