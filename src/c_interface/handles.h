// What stands behind the opaque types of kairos/kairos.h, and how exceptions become statuses.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <string>

#include <kairos/error.h>
#include <kairos/kairos.h>
#include <kairos/names.h>
#include <kairos/render.h>
#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos::c_interface {

struct Counted {
  mutable std::atomic<size_t> references{1};
};

template <class T>
void retain(T* object) {
  if (object != nullptr) object->references.fetch_add(1, std::memory_order_relaxed);
}
template <class T>
void release(T* object) {
  if (object != nullptr && object->references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete object;
}

/// Remembers the exception that is being handled for kairos_last_error, and says of which kind it is.
kairos_status failed() noexcept;

/// No exception leaves.
template <class Work>
kairos_status guarded(const Work& work) noexcept {
  try {
    work();
    return KAIROS_OK;
  } catch (...) {
    return failed();
  }
}

[[noreturn]] inline void refuse(const char* place, const std::string& message) {
  throw Error(ErrorCode::bad_usage, place, message);
}

template <class T>
T& needed(T* given, const char* name) {
  if (given == nullptr) refuse(name, "is NULL");
  return *given;
}

/// A struct of a program whose header may be older or newer than this one. NULL: all defaults.
template <class T>
T taken(const T* given, const char* name) {
  T out{};
  if (given == nullptr) return out;
  if (given->struct_size < sizeof(given->struct_size))
    refuse(name, "has no struct_size; set it to the struct's sizeof");
  std::memcpy(&out, given, std::min<size_t>(given->struct_size, sizeof(T)));
  return out;
}

/// Calls use(element) for an array of a program's structs, which may be shorter or longer than this header's.
template <class T, class Use>
void for_each(const T* given, size_t count, const char* name, const Use& use) {
  if (count == 0) return;
  const size_t step = needed(given, name).struct_size;
  if (step % alignof(T) != 0) refuse(name, "has a struct_size that is no struct's");
  const auto* at = reinterpret_cast<const std::byte*>(given);
  for (size_t i = 0; i < count; ++i) use(*reinterpret_cast<const T*>(at + i * step));
}

/// Vertices, keys and triangles.
Mesh mesh_of(const kairos_mesh& given);

/// Leaves `out` as it is for NULL.
inline void take(const char* given, std::string& out) {
  if (given != nullptr) out = given;
}
template <class Enum>
Enum choice(const char* option, const std::string& name) {
  if (const auto value = parse<Enum>(name)) return *value;
  std::string known;
  for (const auto& [text, value] : kNames<Enum>) known += (known.empty() ? "" : ", ") + std::string(text);
  refuse(option, "'" + name + "' is not one of: " + known);
}
template <class Enum>
void take(const char* option, const char* given, Enum& out) {
  if (given != nullptr) out = choice<Enum>(option, given);
}

}  // namespace kairos::c_interface

struct kairos_scene : kairos::c_interface::Counted {
  std::shared_ptr<const kairos::Scene> scene;
};
struct kairos_shot : kairos::c_interface::Counted {
  kairos::Shot shot;
  /// Of an automatic choice of lights: the same without those that were lent, for shadings that need none.
  std::unique_ptr<const kairos::Shot> unlit;
  bool transparent = false;
};
