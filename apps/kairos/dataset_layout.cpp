#include "dataset_layout.h"

#include <array>

#include "frames.h"

namespace kairos::cli {

namespace {

constexpr std::array<DatasetLayout, 5> kLayouts{{
    // S. Nah et al. 2017.
    {"gopro", 1, false, "SEQ/blur/%06d.png", "SEQ/sharp/%06d.png", "", "", "", ""},
    // S. Nah et al. 2019.
    {"reds", 0, false, "train_blur/SEQ/%08d.png", "train_sharp/SEQ/%08d.png", "", "", "", ""},
    // M. Cao et al. 2022.
    {"bs-rsc", 0, true, "SEQ/RS/%04d.png", "SEQ/GS/%04d.png", "", "", "", ""},
    // P. Liu et al. 2020.
    {"fastec-rs", 0, true, "SEQ/%03d_rolling.png", "SEQ/%03d_global_middle.png", "SEQ/%03d_global_first.png", "", "",
     "SEQ/meta.log"},
    // D. Butler et al. 2012.
    {"sintel", 1, false, "final/SEQ/frame_%04d.png", "clean/SEQ/frame_%04d.png", "", "flow/SEQ/frame_%04d.flo",
     "occlusions/SEQ/frame_%04d.png", ""},
}};

}  // namespace

std::span<const DatasetLayout> dataset_layouts() { return kLayouts; }

std::string dataset_file(const char* pattern, const std::string& sequence, int number) {
  std::string name = pattern;
  const size_t at = name.find("SEQ");
  const std::string before = name.substr(0, at), after = name.substr(at + 3);
  return before + sequence + (after.find('%') == after.npos ? after : FrameName("", after).at(number));
}

}  // namespace kairos::cli
