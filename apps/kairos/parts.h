// Parts of a job: what one of many machines renders of a frame, and the files that hold it until they are merged.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <kairos/image.h>
#include <kairos/render.h>

namespace kairos::cli {

struct Part {
  int index = 0, count = 1;  ///< 0 <= index < count
};

/// "I/N" with I from 1 to N, at most 65536; or "slurm": what the environment of a Slurm array says of the task that
/// this is. Throws CLI::ValidationError that names the option.
Part parse_part(const std::string& option, std::string_view text);

/// "I/N"
std::string part_text(Part part);

/// The rows of `whole` that a part has: as many strips of `unit` rows as every other one, or one more. Throws
/// Error(bad_usage) where there are fewer strips than parts.
Crop band_of(const Crop& whole, Part part, int unit = 1);

/// The folder that holds the parts of the file `out`, and the file of one of them. Parts of pictures are EXR, whatever
/// `out` is.
std::string parts_folder(const std::string& out);
std::string part_file(const std::string& out, Part part, const char* ending = ".exr");

/// Is any file with this ending in the folder of parts?
bool has_parts(const std::string& out, const char* ending);

/// The files with this ending in the folder of parts, by their parts' numbers: all of one job, each once. Throws
/// Error(bad_input) that says which are missing or have another name than part_file gives.
std::vector<std::string> all_part_files(const std::string& out, const char* ending);

/// Makes the folder of a part's file. Throws Error(io).
void make_parts_folder(const std::string& part_file);

/// Says in the part's header what it is part of: which one, of which frame (-1 where the command renders no sequence),
/// made how (frame_mark.h), and to be written how.
void describe_part(Image& image, Part part, int frame, const std::string& mark, const WriteOptions& write);

/// How a part of a picture is written: in the same number of bits.
WriteOptions part_options(const std::string& out, const WriteOptions& of_picture);

/// Throws Error(bad_input): a part is there that was made otherwise.
[[noreturn]] void refuse_other_part(const std::string& path);

/// Is a part, or a frame of a sequence, that was made as `mark` says there, and whole? Throws Error(bad_input) where
/// there is one with another mark: nobody's picture is lost.
bool is_part_there(const std::string& path, const std::string& mark);

struct MergedPicture {
  Image image;
  WriteOptions write;              ///< as its parts were told
  std::vector<std::string> parts;  ///< names of their files
};

/// The picture `out` from the files of its parts. Pixels are copied, nothing is added. Throws Error(bad_input) where
/// one is missing, damaged, or of another job: with the parts' numbers, and what to do.
MergedPicture merge_parts(const std::string& out);

/// Removes the files of the parts, and their folder where nothing else is in it.
void remove_parts(const std::vector<std::string>& parts, const std::string& out);

}  // namespace kairos::cli
