// Python's values as Kairos' and back. What cannot be used is an Error(bad_usage) that names it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/scene.h>

namespace kairos::python {

namespace py = pybind11;

[[noreturn]] inline void refuse(const std::string& name, const std::string& why) {
  throw Error(ErrorCode::bad_usage, name, why);
}

template <class T>
T cast(const std::string& name, py::handle value, const char* what) {
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    refuse(name, py::repr(value).cast<std::string>() + " is not " + what);
  }
}

// read(NAME, VALUE, OUT), from what is simple to what is made of it.

inline void read(const std::string& name, py::handle value, double& out) {
  out = cast<double>(name, value, "a number");
}
inline void read(const std::string& name, py::handle value, float& out) { out = cast<float>(name, value, "a number"); }
inline void read(const std::string& name, py::handle value, bool& out) { out = cast<bool>(name, value, "a bool"); }
inline void read(const std::string& name, py::handle value, std::string& out) {
  out = cast<std::string>(name, value, "text");
}
inline void read(const std::string& name, py::handle value, int& out) {
  out = cast<int>(name, value, "a whole number of 32 bits");
}
inline void read(const std::string& name, py::handle value, uint32_t& out) {
  out = cast<uint32_t>(name, value, "a whole number from 0 to 2^32 - 1");
}
inline void read(const std::string& name, py::handle value, uint64_t& out) {
  out = cast<uint64_t>(name, value, "a whole number from 0 to 2^64 - 1");
}

template <class Enum>
requires(std::is_enum_v<Enum>) void read(const std::string& name, py::handle value, Enum& out) {
  const std::string text = cast<std::string>(name, value, "text");
  const auto found = parse<Enum>(text);
  if (found) {
    out = *found;
    return;
  }
  std::string known;
  for (const auto& [other, ignored] : kNames<Enum>) known += (known.empty() ? "" : ", ") + std::string(other);
  refuse(name, "'" + text + "' is not one of: " + known);
}

template <class T>
void read(const std::string& name, py::handle value, Vec3<T>& out);

template <class T, size_t N>
void read(const std::string& name, py::handle value, std::array<T, N>& out) {
  const auto parts =
      cast<std::vector<py::object>>(name, value, ("a sequence of " + std::to_string(N) + " values").c_str());
  if (parts.size() != N) refuse(name, "has " + std::to_string(parts.size()) + " values, not " + std::to_string(N));
  for (size_t i = 0; i < N; ++i) read(name, parts[i], out[i]);
}
template <class T>
void read(const std::string& name, py::handle value, Vec3<T>& out) {
  std::array<T, 3> parts{};
  read(name, value, parts);
  out = {parts[0], parts[1], parts[2]};
}
/// From rows to Matrix' columns.
inline void read(const std::string& name, py::handle value, Matrix& out) {
  std::array<std::array<double, 4>, 4> rows{};
  for (size_t r = 0; r < 4; ++r) read(name, value[py::int_(r)], rows[r]);
  for (size_t r = 0; r < 4; ++r)
    for (size_t c = 0; c < 4; ++c) out[c][r] = rows[r][c];
}

template <class T>
void read(const std::string& name, py::handle value, std::optional<T>& out) {
  out.reset();
  if (!value.is_none()) read(name, value, out.emplace());
}

template <class T>
requires(std::is_enum_v<T>) void read(const std::string& name, py::handle value, std::vector<T>& out) {
  out.clear();
  for (const py::handle item : value) read(name, item, out.emplace_back());
}

// to_python(VALUE)

template <class T>
requires(std::is_arithmetic_v<T>) py::object to_python(const T& value) { return py::cast(value); }
inline py::object to_python(const std::string& value) { return py::str(value); }
template <class T>
py::object to_python(const Vec3<T>& v) {
  return py::make_tuple(v.x, v.y, v.z);
}
template <class Enum>
requires(std::is_enum_v<Enum>) py::object to_python(const Enum& value) {
  return py::str(std::string(to_string(value)));
}
template <class T, size_t N>
py::object to_python(const std::array<T, N>& values) {
  py::tuple out(N);
  for (size_t i = 0; i < N; ++i) out[i] = to_python(values[i]);
  return out;
}
template <class T>
py::object to_python(const std::optional<T>& value) {
  return value ? to_python(*value) : py::none();
}
template <class T>
requires(std::is_enum_v<T>) py::object to_python(const std::vector<T>& values) {
  py::tuple out(values.size());
  for (size_t i = 0; i < values.size(); ++i) out[i] = to_python(values[i]);
  return out;
}

// In scene.cpp.
void read(const std::string& name, py::handle value, TextureRef& out);
py::object to_python(const TextureRef& texture);

/// Takes a struct's members from a dict by their names. A member that the dict lacks keeps its value.
class Reader {
 public:
  Reader(std::string place, const py::dict& values) : place_(std::move(place)), values_(values.attr("copy")()) {}

  template <class T>
  void operator()(const char* name, T& out) {
    if (!values_.contains(name)) return;
    read(place_.empty() ? name : place_ + ", " + name, values_[name], out);
    values_.attr("pop")(name);
  }
  /// A member as it is; None where there is none.
  py::object take(const char* name) { return values_.attr("pop")(name, py::none()); }
  /// Refuses what nobody has asked for.
  void finish() const {
    for (const auto& [name, value] : values_)
      refuse(place_ + (place_.empty() ? "" : ", ") + py::str(name).cast<std::string>(),
             "is no option; see help(kairos)");
  }

 private:
  std::string place_;
  py::dict values_;
};

/// Makes a dict of a struct's members.
class Writer {
 public:
  template <class T>
  void operator()(const char* name, const T& value) {
    values[name] = to_python(value);
  }
  py::dict values;
};

// Arrays.

/// A C-contiguous array of T whose shape is `shape`, where -1 stands for any length.
template <class T>
py::array_t<T, py::array::c_style> array_of(const std::string& name, py::handle value,
                                            const std::vector<py::ssize_t>& shape) {
  using Array = py::array_t<T, py::array::c_style>;
  const auto text = [](const auto& sides) {
    std::string out;
    for (const py::ssize_t side : sides) out += (out.empty() ? "" : ", ") + (side < 0 ? "N" : std::to_string(side));
    return "(" + out + ")";
  };
  if (!Array::check_(value))
    refuse(name, "is not a C-contiguous array of " + py::str(py::dtype::of<T>()).cast<std::string>());
  const Array array = py::reinterpret_borrow<Array>(value);
  const std::vector<py::ssize_t> has(array.shape(), array.shape() + array.ndim());
  bool fits = has.size() == shape.size();
  for (size_t i = 0; fits && i < shape.size(); ++i) fits = shape[i] < 0 || shape[i] == has[i];
  if (!fits) refuse(name, "has the shape " + text(has) + ", not " + text(shape));
  return array;
}

/// Rows of an array as a vector of structs of the same numbers.
template <class Row, class T>
std::vector<Row> rows_of(const T* data, size_t count) {
  static_assert(sizeof(Row) % sizeof(T) == 0 && std::is_trivially_copyable_v<Row>);
  const auto* rows = reinterpret_cast<const Row*>(data);
  return {rows, rows + count};
}

/// What holds `owner` as long as Python holds an array of its memory.
template <class Owner>
py::capsule keeper(std::unique_ptr<Owner> owner) {
  py::capsule capsule(owner.get(), [](void* held) { delete static_cast<Owner*>(held); });
  (void)owner.release();
  return capsule;
}

/// A vector as an array of its numbers, which are not copied.
template <class T>
py::array_t<T> array_from(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto owner = std::make_unique<std::vector<T>>(std::move(values));
  T* data = owner->data();
  return py::array_t<T>(std::move(shape), data, keeper(std::move(owner)));
}

}  // namespace kairos::python
