// A glTF document whose syntax, types and buffers are known to be sound; what its indices and counts say is not.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <kairos/error.h>
#include <kairos/scene.h>

#include "scene_io/gltf/text.h"
#include "scene_io/gltf/tinygltf.h"

namespace kairos::gltf {

/// Collects warnings so that what happens a thousand times is said once. With `strict` a warning is an Error instead.
class Warnings {
 public:
  Warnings(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  /// `what` is said once, with the place where it was met first and, where it makes sense, how many there were in all.
  void add(const std::string& where, const std::string& what, uint64_t count = 1);
  std::vector<std::string> lines() const;

 private:
  struct Entry {
    std::string where;
    uint64_t count = 0;
  };
  std::string file_;
  bool strict_;
  std::vector<std::string> order_;
  std::map<std::string, Entry> entries_;
};

/// Where an encoded picture is: in a file, in a buffer view or (a data: URI) in `bytes`.
struct ImageSource {
  std::string name;  ///< path, or what an embedded one is called
  bool embedded = false;
  int buffer_view = -1;
  std::vector<uint8_t> bytes;
};

struct Document {
  std::string name;                               ///< for messages
  tinygltf::Model model;                          ///< without buffers and images, which are below
  std::vector<std::span<const uint8_t>> buffers;  ///< as long as byteLength says
  std::vector<ImageSource> images;
  std::vector<std::vector<uint8_t>> buffer_bytes;  ///< what `buffers` point to, other than a GLB's own chunk
  uint64_t memory_left = 0;                        ///< what decoding may still allocate, bytes

  /// Throws Error(bad_input, "name: where").
  [[noreturn]] void fail(const std::string& where, const std::string& message) const;

  /// To be called before anything of a size that the file names is allocated. A file may grow by a large factor when it
  /// is decoded (Draco, sparse accessors, instances), but not without limit.
  void charge(uint64_t bytes, const std::string& where);
};

/// `bytes` is a .gltf or a .glb and must outlive the document. Files that it names must lie in `folder`; none may be
/// named when that is empty. Throws Error.
Document read_document(std::span<const uint8_t> bytes, const std::string& name, const std::string& folder);

/// "nodes[3]".
std::string at(const char* array, size_t index);

/// Throws for a required extension that is not supported, and warns of those that are left out.
void check_extensions(const Document& document, Warnings& warnings);

}  // namespace kairos::gltf
