// The pictures that the page shows: of about the same time, and where they differ most.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <kairos/compare.h>

#include "study/study_folder.h"
#include "study/summary.h"

namespace kairos::study {

struct Picture {
  Setting setting;
  std::string series;  ///< that it stands for
  double seconds = 0, psnr = 0;
  std::string image, error;  ///< data URIs: the picture, and its error codes as grey
};

/// One part of several pictures, enlarged by the page.
struct Crop {
  PixelBox box;
  bool gain = false;  ///< where the method wins most over the baseline; else where it loses most
  struct View {
    std::string label;
    double psnr = 0;    ///< inside of the box
    std::string image;  ///< data URI
  };
  std::vector<View> views;  ///< reference, baselines, method
};

/// A method and the baselines in equal time.
struct EqualTime {
  std::string series;
  int spp = 0;  ///< of the baseline: its time is the one meant
  double seconds = 0;
  Setting setting;          ///< of the method
  std::vector<Crop> crops;  ///< none where both are equally far from the reference
};

struct PagePictures {
  std::string reference;  ///< data URI
  std::vector<Picture> pictures;
  std::vector<EqualTime> pairs;
  int width = 0, height = 0;  ///< as shown: wide pictures are reduced
};

/// Reads the pictures of the entry's first seed from the folder.
PagePictures pictures_of(const EntrySummary& entry, const StudyFolder& folder);

/// Where in a picture of `width` pixels the sum over a box of width x height `size` of a^2 - b^2 is greatest, a and b
/// being the differences that error codes stand for. `size` is no larger than the picture.
PixelBox largest_excess(std::span<const uint8_t> a, std::span<const uint8_t> b, int width, PixelBox size);

}  // namespace kairos::study
