// What files say of events beside their time, place and polarity, each under one name in all formats.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include <kairos/events.h>

namespace kairos {

/// As numpy describes them, with its quotes.
template <class Number>
constexpr const char* npy_descr() {
  static_assert(std::is_same_v<Number, uint32_t> || std::is_same_v<Number, float> || std::is_same_v<Number, bool> ||
                std::is_same_v<Number, uint8_t>);
  if constexpr (std::is_same_v<Number, uint32_t>)
    return "'<u4'";
  else if constexpr (std::is_same_v<Number, float>)
    return "'<f4'";
  else if constexpr (std::is_same_v<Number, bool>)
    return "'|b1'";
  else
    return "'|u1'";
}

/// A label with the event's kind, of which formats without a place of their own for kinds keep it.
struct KindLabel {
  EventLabel label;
  uint8_t kind = 0;  // EventKind

  /// Whatever a file says.
  EventKind event_kind() const { return kind == 1 ? EventKind::leak : kind == 2 ? EventKind::shot : EventKind::signal; }
};
template <class Field, class Label>
void kind_label_fields(Field&& field, Label& all) {
  label_fields(field, all.label);
  field("kind", all.kind);
}

/// Sets a field to a number of a file, or to none that it could be: 0.
inline void set_field(uint32_t& field, double value) {
  field = value >= 0 && value < 0x1p32 ? static_cast<uint32_t>(value) : 0;
}
inline void set_field(float& field, double value) { field = static_cast<float>(value); }
inline void set_field(bool& field, double value) { field = value != 0; }
inline void set_field(uint8_t& field, double value) {
  field = value >= 0 && value < 256 ? static_cast<uint8_t>(value) : 0;
}

}  // namespace kairos
