#include "event_folder/pickle.h"

#include <bit>
#include <cstring>
#include <string>

#include "base/little_endian.h"

namespace kairos {

namespace {

using nlohmann::ordered_json;

/// Opcodes are those of the module pickletools in Python's standard library.
class Pickler {
 public:
  void code(const char* bytes) { out.insert(out.end(), bytes, bytes + std::strlen(bytes)); }
  void text(const std::string& value) {
    code("X");
    put_little(out, static_cast<uint32_t>(value.size()));
    out.insert(out.end(), value.begin(), value.end());
  }
  void whole(int32_t value) {
    code("J");
    put_little(out, value);
  }
  void real(double value) {
    code("G");
    const auto bits = std::bit_cast<uint64_t>(value);  // big endian, unlike all else
    for (int shift = 56; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(bits >> shift));
  }
  void value(const ordered_json& json) {
    if (json.is_object()) {
      code("}(");
      for (const auto& [key, item] : json.items()) {
        text(key);
        value(item);
      }
      code("u");
    } else if (json.is_array()) {
      code("](");
      for (const ordered_json& item : json) value(item);
      code("e");
    } else if (json.is_string()) {
      text(json.get<std::string>());
    } else if (json.is_number_integer()) {
      whole(json.get<int32_t>());
    } else if (json.is_number()) {
      real(json.get<double>());
    } else {
      code("N");
    }
  }

  std::vector<uint8_t> out;
};

}  // namespace

std::vector<uint8_t> pickled_object_array(const ordered_json& value) {
  Pickler pickler;
  // An empty array of bytes, which then takes on a state: version, shape, type, order, items.
  pickler.code(
      "\x80\x03"
      "cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK");
  pickler.out.push_back(0);
  pickler.code(
      "\x85"
      "C\x01"
      "b\x87R(K\x01)cnumpy\ndtype\n");
  pickler.text("O8");
  pickler.code("\x89\x88\x87R(K\x03");
  pickler.text("|");
  pickler.code("NNN");
  pickler.whole(-1);
  pickler.whole(-1);
  pickler.code("K?tb\x89](");
  pickler.value(value);
  pickler.code("etb.");
  return pickler.out;
}

}  // namespace kairos
