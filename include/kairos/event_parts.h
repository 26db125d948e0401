// Parts of a recording of events, each of some of its pixels, and the recording made of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kairos/event_file.h>
#include <kairos/export.h>

namespace kairos {

/// How the file of a part is written, which is .npz, so that nothing is lost of what a file with these options needs.
KAIROS_API EventFileOptions event_part_options(const EventFileOptions& of_recording);

/// Says beside a part's file, in PATH.json, how it was made and how the recording is to be written; with that it is
/// done. mark: what decides the part's events; parts with another one do not belong together. Throws Error(io).
KAIROS_API void write_event_part_notes(const std::string& path, const EventOptions& options, const EventStats& stats,
                                       const std::string& command_line, const EventFileOptions& of_recording,
                                       const std::string& mark);

/// The mark of a part that is done; unset where there is none, or not all of one.
KAIROS_API std::optional<std::string> event_part_mark(const std::string& path);

/// Writes the recording `out`, and OUT.json beside it, of parts that write_event_part_notes finished. All of their
/// events are in memory at a time, 16 bytes each, and 40 with labels. Throws Error(bad_input) where a part is damaged
/// or of another recording than the first, Error(io), and Error(bad_usage) as EventFileWriter does.
KAIROS_API void merge_event_parts(const std::vector<std::string>& parts, const std::string& out);

}  // namespace kairos
