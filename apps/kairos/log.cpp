#include "log.h"

#include <cstdio>
#include <string>

#include <kairos/printable.h>

namespace kairos::cli {

void draw(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); }

void log(std::string_view line) { draw(printable(line, std::string_view::npos) + "\n"); }

}  // namespace kairos::cli
