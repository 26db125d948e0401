// How much of the machine's processors a container, or a scheduler's job, may use.
#pragma once

#include <limits>
#include <string>

namespace kairos {

inline constexpr double kNoCpuLimit = std::numeric_limits<double>::infinity();

/// Processors that the control groups of this process grant in the mean: the least quota of its group and those above
/// it, of version 2 (cpu.max) or 1 (cpu.cfs_quota_us). kNoCpuLimit where there is none. groups: which groups those are;
/// root: where their files lie.
double cgroup_cpus(const std::string& groups = "/proc/self/cgroup", const std::string& root = "/sys/fs/cgroup");

}  // namespace kairos
