// Where everything in a shot is, as bytes: meshes, their keys, the camera. Not what surfaces look like.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <kairos/scene.h>

namespace kairos {

/// docs/time.md, "The file".
std::vector<uint8_t> shot_bytes(const Shot& shot);

/// Throws Error(bad_input, place) for bytes that are no shot. What blends is left out, as shot_bytes leaves it out.
Shot parse_shot(std::span<const uint8_t> bytes, double open, double close, const std::string& place);

}  // namespace kairos
