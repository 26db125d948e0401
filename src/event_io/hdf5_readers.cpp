#include "event_io/hdf5_readers.h"

#include "event_io/event_format.h"
#include "event_io/hdf5_file.h"

namespace kairos {

EventFileFacts read_hdf5(const std::string& path, EventSink& sink) {
  silence_hdf5();
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) throw Error(ErrorCode::bad_input, path, "is no HDF5 file that can be read");
  const Hdf5Handle file(id, H5Fclose, path);
  if (H5Lexists(file, "CD", H5P_DEFAULT) > 0) return read_metavision(path, file, sink);
  if (H5Lexists(file, "events", H5P_DEFAULT) > 0) return read_dsec(path, file, sink);
  throw Error(ErrorCode::bad_input, path,
              "is laid out neither as DSEC's files are, with a group 'events', nor as Metavision's, with a group 'CD'");
}

}  // namespace kairos
