// What reading and writing OpenEXR have in common.
#pragma once

#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include <OpenEXR/ImfFrameBuffer.h>

#include <kairos/error.h>

namespace kairos {

/// Exceptions of the library become ours: one line, with the file's name in front.
template <class Body>
auto translate_exr_errors(const std::string& path, ErrorCode code, const char* what, Body&& body) {
  try {
    return body();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    std::string why = e.what();
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw Error(code, path, std::string(what) + ": " + why);
  }
}

/// Imf wants to know where pixel (0, 0) of the full frame would be.
inline Imf::Slice exr_slice(Imf::PixelType type, char* first, size_t value_size, const Imath::Box2i& window) {
  const size_t width = static_cast<size_t>(window.max.x - window.min.x) + 1;
  return Imf::Slice::Make(type, first, window, value_size, value_size * width);
}

}  // namespace kairos
