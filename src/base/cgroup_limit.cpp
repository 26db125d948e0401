#include "base/cgroup_limit.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace kairos {

namespace {

namespace fs = std::filesystem;

/// Microseconds of processor time in each period of so many; "max" and -1 stand for no limit.
double cpus_of(const std::string& quota, double period) {
  char* end = nullptr;
  const double microseconds = std::strtod(quota.c_str(), &end);
  return end != quota.c_str() && microseconds > 0 && period > 0 ? microseconds / period : kNoCpuLimit;
}

double limit_v2(const fs::path& group) {
  std::ifstream file(group / "cpu.max");
  std::string quota;
  double period = 0;
  file >> quota >> period;
  return file ? cpus_of(quota, period) : kNoCpuLimit;
}

double limit_v1(const fs::path& group) {
  std::ifstream quota_file(group / "cpu.cfs_quota_us"), period_file(group / "cpu.cfs_period_us");
  std::string quota;
  double period = 0;
  quota_file >> quota;
  period_file >> period;
  return quota_file && period_file ? cpus_of(quota, period) : kNoCpuLimit;
}

/// The least limit of a group below `hierarchy` and all above it. In a container the group's own path may not be there:
/// then the container's group is the hierarchy's root.
template <class Limit>
double least(const fs::path& hierarchy, const std::string& path, const Limit& limit) {
  fs::path group = hierarchy;
  double result = limit(group);
  for (const fs::path& name : fs::path(path).relative_path()) {
    group /= name;
    result = std::min(result, limit(group));
  }
  return result;
}

/// Is `word` one of `list`, which commas separate?
bool names(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::string_view first = list.substr(0, list.find(','));
    if (first == word) return true;
    list.remove_prefix(std::min(list.size(), first.size() + 1));
  }
  return false;
}

}  // namespace

double cgroup_cpus(const std::string& groups, const std::string& root) {
  double result = kNoCpuLimit;
  std::ifstream file(groups);
  for (std::string line; std::getline(file, line);) {  // number:controllers:path
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == line.npos || second == line.npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), path = line.substr(second + 1);
    if (controllers.empty()) {
      for (const char* mount : {"", "unified"})
        result = std::min(result, least(fs::path(root) / mount, path, limit_v2));
    } else if (names(controllers, "cpu")) {
      for (const std::string& mount : {controllers, std::string("cpu")})
        result = std::min(result, least(fs::path(root) / mount, path, limit_v1));
    }
  }
  return result;
}

}  // namespace kairos
