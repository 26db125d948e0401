// Readers of what an open HDF5 file holds.
#pragma once

#include <string>

#include <hdf5.h>

#include <kairos/event_file.h>

namespace kairos {

/// With a group 'events', as DSEC's files have. Throws Error(bad_input) or Error(io).
EventFileFacts read_dsec(const std::string& path, hid_t file, EventSink& sink);
/// With a group 'CD'. Throws as above.
EventFileFacts read_metavision(const std::string& path, hid_t file, EventSink& sink);

}  // namespace kairos
