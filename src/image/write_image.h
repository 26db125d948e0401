// Which format a name stands for.
#pragma once

#include <string>
#include <string_view>

namespace kairos {

/// extension: with its dot, in lower case; the path's may be in any.
bool has_extension(const std::string& path, std::string_view extension);

}  // namespace kairos
