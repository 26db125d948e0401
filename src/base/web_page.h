// Pages that need nothing beside themselves to be shown.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kairos {

/// `html` with the other three in place of its /*style*/, /*script*/ and /*data*/, of which it has one each. data:
/// JSON.
std::string web_page(std::string html, const std::string& style, const std::string& script, const std::string& data);

std::string base64(std::span<const uint8_t> bytes);

}  // namespace kairos
