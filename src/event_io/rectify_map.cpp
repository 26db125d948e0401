#include "event_io/rectify_map.h"

#include <array>
#include <vector>

#include "event_io/hdf5_file.h"

namespace kairos {

void write_rectify_map(const std::string& path, int width, int height) {
  std::vector<float> places;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      places.push_back(static_cast<float>(x));
      places.push_back(static_cast<float>(y));
    }
  Hdf5Output file(path);
  const std::array<hsize_t, 3> shape{static_cast<hsize_t>(height), static_cast<hsize_t>(width), 2};
  {
    const Hdf5Handle space(H5Screate_simple(3, shape.data(), nullptr), H5Sclose, path),
        how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path);
    H5Pset_obj_track_times(how, false);
    const Hdf5Handle set(H5Dcreate2(file, "rectify_map", H5T_IEEE_F32LE, space, H5P_DEFAULT, how, H5P_DEFAULT),
                         H5Dclose, path);
    if (H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, places.data()) < 0)
      throw Error(ErrorCode::io, path, "cannot be written: the HDF5 library refused");
  }
  file.finish();
}

}  // namespace kairos
