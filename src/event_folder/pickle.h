// Objects as Python's pickle has them, and as numpy reads them from an array of one object.
#pragma once

#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

namespace kairos {

/// The pickle (protocol 3) of a numpy array without dimensions that holds the value: dictionaries, lists, texts and
/// numbers. What stands behind the header of an .npy file of the type '|O'.
std::vector<uint8_t> pickled_object_array(const nlohmann::ordered_json& value);

}  // namespace kairos
