// Facts about a run that more than one subcommand tells.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <kairos/scene.h>

namespace kairos::cli {

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

uint64_t triangle_count(const std::vector<Mesh>& meshes);
/// Bytes of the meshes' arrays.
uint64_t mesh_bytes(const Mesh& mesh);
uint64_t mesh_bytes(const std::vector<Mesh>& meshes);
/// The most memory that the process has held so far, bytes.
uint64_t peak_memory_bytes();
/// "1 mesh", "2 meshes".
std::string amount(size_t count, const char* one, const char* many);
/// "12.3 MB".
std::string megabytes(uint64_t bytes);

}  // namespace kairos::cli
