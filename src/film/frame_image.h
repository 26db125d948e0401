// A picture of the frame over which something was recorded.
#pragma once

#include <kairos/image.h>
#include <kairos/time_picture.h>

namespace kairos {

/// As large as the frame, in its place and with its attributes; without channels.
inline Image frame_image(const TimeFrame& frame) {
  Image image;
  image.width = frame.width;
  image.height = frame.height;
  image.left = frame.left;
  image.top = frame.top;
  image.frame_width = frame.frame_width;
  image.frame_height = frame.frame_height;
  image.pixel_aspect = frame.pixel_aspect;
  image.attributes = frame.attributes;
  return image;
}

}  // namespace kairos
