#include "dataset_layout.h"

#include <array>

#include "frames.h"

namespace kairos::cli {

namespace {

constexpr std::array<DatasetLayout, 8> kLayouts{{
    // S. Nah et al. 2017.
    {.name = "gopro", .first_number = 1, .exposed = "SEQ/blur/%06d.png", .sharp = "SEQ/sharp/%06d.png"},
    // S. Nah et al. 2019.
    {.name = "reds", .exposed = "train_blur/SEQ/%08d.png", .sharp = "train_sharp/SEQ/%08d.png"},
    // M. Cao et al. 2022.
    {.name = "bs-rsc", .rolls = true, .exposed = "SEQ/RS/%04d.png", .sharp = "SEQ/GS/%04d.png"},
    // P. Liu et al. 2020.
    {.name = "fastec-rs",
     .rolls = true,
     .exposed = "SEQ/%03d_rolling.png",
     .sharp = "SEQ/%03d_global_middle.png",
     .sharp_first = "SEQ/%03d_global_first.png",
     .log = "SEQ/meta.log"},
    // The same authors.
    {.name = "carla-rs",
     .rolls = true,
     .exposed = "SEQ/%04d_rs.png",
     .sharp = "SEQ/%04d_gs_m.png",
     .sharp_first = "SEQ/%04d_gs_f.png",
     .depth = "SEQ/%04d_rs.pdepth",
     .undistort = "SEQ/%04d_gs_m.flo",
     .undistort_first = "SEQ/%04d_gs_f.flo",
     .undistort_seen = "SEQ/%04d_mask.png",
     .velocity = "SEQ/gt_vel.log"},
    // D. Butler et al. 2012.
    {.name = "sintel",
     .first_number = 1,
     .exposed = "final/SEQ/frame_%04d.png",
     .sharp = "clean/SEQ/frame_%04d.png",
     .flow = "flow/SEQ/frame_%04d.flo",
     .occlusion = "occlusions/SEQ/frame_%04d.png"},
    // M. Menze and A. Geiger 2015.
    {.name = "kitti",
     .exposed = "SEQ/training/image_2/%06d_10.png",
     .flow = "SEQ/training/flow_occ/%06d_10.png",
     .exposed_next = "SEQ/training/image_2/%06d_11.png",
     .flow_seen = "SEQ/training/flow_noc/%06d_10.png"},
    // O. Seiskari et al. 2024.
    {.name = "3dgs-deblur", .exposed = "SEQ/images/%05d.png", .transforms = "SEQ/transforms.json", .sharp_every = 8},
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
