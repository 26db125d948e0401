// A glTF document whose syntax and types are known to be sound; what its indices and counts say is not.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <kairos/error.h>

#include "base/file.h"
#include "base/memory_budget.h"
#include "scene_io/gltf/file_model.h"
#include "scene_io/gltf/text.h"
#include "scene_io/gltf/warnings.h"

namespace kairos::gltf {

struct Document {
  std::string name;    ///< for messages
  SceneFolder folder;  ///< that files it names are found from; without a path none may be named
  file::Model model;
  MemoryBudget* budget = nullptr;  ///< of the scene that it becomes a part of

  /// Throws Error(bad_input, "name: where").
  [[noreturn]] void fail(const std::string& where, const std::string& message) const;

  /// To be called before anything of a size that the file names is allocated. A file may grow by a large factor when it
  /// is decoded (Draco, sparse accessors, instances), but not without limit.
  void charge(uint64_t bytes, const std::string& where);

  /// `length` bytes at `offset` of a buffer view, which is read and unpacked when it is first asked for: what nothing
  /// uses may be missing. Throws Error at `where` when they are not all there.
  std::span<const uint8_t> view_bytes(int view, uint64_t offset, uint64_t length, const std::string& where);

  /// As long as its byteLength. Throws Error when there are not so many bytes.
  std::span<const uint8_t> buffer(int index, const std::string& user);

  std::span<const uint8_t> binary;  ///< a GLB's own chunk

 private:
  std::span<const uint8_t> unpacked(size_t view, const std::string& where);

  std::map<int, std::span<const uint8_t>> buffers_;    // those that were asked for
  std::map<std::string, std::vector<uint8_t>> files_;  // by path: a file named often is read once
  std::map<int, std::vector<uint8_t>> data_;           // of data: URIs, by buffer
  std::map<size_t, std::vector<uint8_t>> unpacked_;    // by view
};

/// `bytes` is a .gltf or a .glb and must outlive the document, as must `budget`. What it holds and is not read is named
/// in `warnings`. Throws Error.
Document read_document(std::span<const uint8_t> bytes, const std::string& name, const SceneFolder& folder,
                       MemoryBudget& budget, Warnings& warnings);

/// A file's path from a URI, where the document may read: backslashes, which URIs have not, count as slashes. Throws
/// Error at `where`.
std::string path_of_uri(const Document& document, const std::string& uri, const std::string& where);

/// "nodes[3]".
std::string at(const char* array, size_t index);

}  // namespace kairos::gltf
