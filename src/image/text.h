// Small labels in pictures.
#pragma once

#include <string>

#include <kairos/image.h>

namespace kairos {

/// Height of a line of text, pixels.
int text_height(int scale);

/// Writes one line of ASCII text (other characters show as '?') in white on a darkened ground, its top left corner at
/// pixel (x, y). `scale` is the size of a dot of the font, pixels, at least 1. What lies outside the picture is cut.
void draw_text(Image& image, int x, int y, int scale, const std::string& text);

}  // namespace kairos
