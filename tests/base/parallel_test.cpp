// Threads: arenas of their own, watched and stopped by the thread that called.
#include "base/parallel.h"

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include <kairos/error.h>

#include "base/cgroup_limit.h"
#include "temp_folder.h"

namespace kairos {
namespace {

TEST(Parallel, AnArenaHasTheThreadsAskedFor) {
  for (const int threads : {1, 2, 3, 7}) {
    int counted = 0;
    with_threads(threads, [&] { counted = thread_count(); });
    EXPECT_EQ(counted, threads);
    with_threads(
        threads, [&] { counted = thread_count(); }, [] { return true; });
    EXPECT_EQ(counted, threads) << "watched";
    with_threads(threads, [&] { with_threads(0, [&] { counted = thread_count(); }); });
    EXPECT_EQ(counted, threads) << "no wish of its own";
  }
}

TEST(Parallel, ControlGroupsLimitProcessors) {
  const TempFolder folder;
  const auto cpus = [&](const std::string& groups) {
    return cgroup_cpus(folder.write("groups", groups), folder.path("fs"));
  };
  EXPECT_EQ(cpus("0::/\n"), kNoCpuLimit);
  EXPECT_EQ(cpus(""), kNoCpuLimit);
  EXPECT_EQ(cgroup_cpus(folder.path("absent"), folder.path("absent")), kNoCpuLimit);
  // Version 2: the least of a group's own and those above it.
  folder.write("fs/a/b/cpu.max", "max 100000\n");
  EXPECT_EQ(cpus("0::/a/b\n"), kNoCpuLimit);
  folder.write("fs/a/cpu.max", "150000 100000\n");
  EXPECT_EQ(cpus("0::/a/b\n"), 1.5);
  EXPECT_EQ(cpus("0::/a/b/not/there\n"), 1.5);
  EXPECT_EQ(cpus("0::/c\n"), kNoCpuLimit);
  folder.write("fs/a/b/cpu.max", "25000 50000 \n");
  EXPECT_EQ(cpus("0::/a/b\n"), 0.5);
  folder.write("fs/a/b/cpu.max", "nonsense");
  EXPECT_EQ(cpus("0::/a/b\n"), 1.5);
  // Version 1, whose folder has one name or that of all its controllers.
  folder.write("fs/cpu,cpuacct/job/cpu.cfs_quota_us", "300000\n");
  folder.write("fs/cpu,cpuacct/job/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(cpus("4:memory:/job\n3:cpu,cpuacct:/job\n0::/\n"), 3);
  EXPECT_EQ(cpus("3:cpuacct:/job\n2:cpuset:/job\n"), kNoCpuLimit);
  folder.write("fs/cpu/job/cpu.cfs_quota_us", "-1\n");
  folder.write("fs/cpu/job/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(cpus("1:cpu:/job\n"), kNoCpuLimit);
}

TEST(Parallel, OneThreadStaysOne) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  with_threads(1, [&] {
    parallel_for(1000, 1, [&](size_t, size_t) {
      const std::lock_guard<std::mutex> lock(mutex);
      seen.insert(std::this_thread::get_id());
    });
  });
  EXPECT_EQ(seen, std::set<std::thread::id>{std::this_thread::get_id()});
}

// Each part of the loop waits until as many are under way as the arena has threads: both loops end only if each has its
// own number at the same time.
TEST(Parallel, ArenasDoNotBindEachOther) {
  std::atomic<bool> one_runs{false}, three_are_done{false};
  const auto wait_for = [](const std::atomic<bool>& flag) {
    while (!flag) std::this_thread::yield();
  };
  std::thread other([&] {
    with_threads(1, [&] {
      EXPECT_EQ(thread_count(), 1);
      one_runs = true;
      wait_for(three_are_done);
    });
  });
  wait_for(one_runs);
  std::atomic<int> under_way{0};
  with_threads(3, [&] {
    parallel_for(3, 1, [&](size_t, size_t) {
      ++under_way;
      while (under_way < 3) std::this_thread::yield();
    });
  });
  three_are_done = true;
  other.join();
  EXPECT_EQ(under_way, 3);
}

TEST(Parallel, TheCallingThreadWatches) {
  int calls = 0;
  std::atomic<bool> enough{false};
  const auto caller = std::this_thread::get_id();
  with_threads(
      2,
      [&] {
        EXPECT_NE(std::this_thread::get_id(), caller);
        while (!enough) std::this_thread::yield();
      },
      [&] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        enough = ++calls == 3;
        return true;
      });
  EXPECT_GE(calls, 3);
}

TEST(Parallel, AWatchThatSaysNoStopsTheWork) {
  for (const int threads : {1, 2}) {
    std::atomic<bool> begun{false};
    std::atomic<uint64_t> pieces{0};
    try {
      with_threads(
          threads,
          [&] {
            parallel_for(size_t{1} << 40, 1, [&](size_t, size_t) {  // would take days
              ++pieces;
              begun = true;
            });
            ADD_FAILURE() << "went on";
          },
          [&] { return !begun; });
      ADD_FAILURE() << "went on";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
    EXPECT_GT(pieces, 0u);
  }
}

TEST(Parallel, WorkWithoutLoopsCanAsk) {
  EXPECT_NO_THROW(throw_if_cancelled());
  EXPECT_THROW(with_threads(
                   2,
                   [] {
                     for (;;) {
                       parallel_for(1, 1, [](size_t, size_t) { throw_if_cancelled(); });
                       throw_if_cancelled();
                     }
                   },
                   [] { return false; }),
               Error);
}

TEST(Parallel, ExceptionsReachTheCaller) {
  const auto fail = [] { throw std::runtime_error("work"); };
  EXPECT_THROW(with_threads(2, fail), std::runtime_error);
  EXPECT_THROW(with_threads(2, fail, [] { return true; }), std::runtime_error);
  const auto in_a_loop = [] { parallel_for(100, 1, [](size_t, size_t) { throw std::runtime_error("piece"); }); };
  EXPECT_THROW(with_threads(2, in_a_loop, [] { return true; }), std::runtime_error);
  // Of the watch: the work is stopped, and what it says about that is not told.
  const auto endless = [] {
    for (;;) throw_if_cancelled();
  };
  EXPECT_THROW(with_threads(2, endless, []() -> bool { throw std::logic_error("watch"); }), std::logic_error);
}

}  // namespace
}  // namespace kairos
