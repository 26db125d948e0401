// What a frame of a sequence was made with, as a mark in its file: whoever goes on with a sequence keeps to it.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace kairos::cli {

/// The attribute that holds the mark: in the header of EXR, as a text chunk of PNG.
inline constexpr const char* kFrameMarkName = "kairos:frame_mark";

/// 16 hexadecimal digits that follow from the program's version, the instruction sets of this machine, what was given
/// for `command`'s options (but those named in `apart`, as they decide no pixel, or are files and among `files`), and
/// the bytes of `files`. Files that cannot be read count as empty: whoever loads them says so.
std::string frame_mark(const CLI::App& command, const std::vector<std::string>& apart,
                       const std::vector<std::string>& files);

/// The mark in a picture's file; empty when it has none.
std::string read_frame_mark(const std::string& path);

/// Is the file what a full disk or a lost write leaves of an EXR or PNG: empty, or begun as one and not whole? Reads
/// all of it. Throws Error(io) where it can't be read.
bool is_damaged_picture(const std::string& path);

}  // namespace kairos::cli
