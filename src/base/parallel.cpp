#include "base/parallel.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <kairos/error.h>

#include "base/cgroup_limit.h"

#if defined(__SANITIZE_THREAD__)
#define KAIROS_SANITIZES_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define KAIROS_SANITIZES_THREADS 1
#endif
#endif
#if defined(KAIROS_SANITIZES_THREADS)
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace kairos {

namespace {

constexpr std::chrono::milliseconds kWatchInterval(50);

[[noreturn]] void throw_cancelled() { throw Error(ErrorCode::cancelled, "", "rendering was stopped"); }

/// Work given from one thread to another. TBB is not built with ThreadSanitizer, which therefore has to be told that
/// what happened before sending is known after receiving.
class HandOver {
 public:
#if defined(KAIROS_SANITIZES_THREADS)
  void send() { __tsan_release(&mark_); }
  void receive() { __tsan_acquire(&mark_); }
#else
  void send() {}
  void receive() {}
#endif

 private:
  [[maybe_unused]] char mark_ = 0;
};

/// Runs something when a block is left, by an exception too.
template <class Do>
class AtTheEnd {
 public:
  explicit AtTheEnd(const Do& what) : do_(what) {}
  ~AtTheEnd() { do_(); }
  AtTheEnd(const AtTheEnd&) = delete;
  AtTheEnd& operator=(const AtTheEnd&) = delete;

 private:
  const Do do_;
};

/// Calls `run(wrapped)` with a body that may be called on any thread, many times, before `run` returns.
template <class Run, class Body>
void hand_over(const Run& run, const Body& body) {
  HandOver there, back;  // two, so that nothing is said about one call of the body and the next
  const AtTheEnd received([&] { back.receive(); });
  there.send();
  run([&](const auto&... arguments) {
    there.receive();
    const AtTheEnd sent([&] { back.send(); });
    body(arguments...);
  });
}

/// As many threads as the machine has that this process may run on (TBB asks for those), but no more than a control
/// group lets work at a time: others would only wait for their turn, all of them at once.
int machine_threads() {
  static const int threads = [] {
    const double most = std::ceil(cgroup_cpus());
    const int all = tbb::info::default_concurrency();
    return most < all ? std::max(static_cast<int>(most), 1) : all;
  }();
  return threads;
}

class Arena {
 public:
  explicit Arena(int threads) : arena_(threads) {
    // TBB makes no more threads than the machine has unless it is told to. Nobody else is bound by this.
    if (threads > tbb::info::default_concurrency())
      allowance_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
  }
  template <class Body>
  void execute(const Body& body) {
    hand_over([&](const auto& wrapped) { arena_.execute(wrapped); }, body);
  }

 private:
  std::optional<tbb::global_control> allowance_;
  tbb::task_arena arena_;
};

/// Work on a thread of its own that can be told to stop.
class WatchedWork {
 public:
  WatchedWork(int threads, const std::function<void()>& body)
      : arena_(threads), thread_([this, &body] { run(body); }) {}
  ~WatchedWork() { thread_.join(); }
  WatchedWork(const WatchedWork&) = delete;
  WatchedWork& operator=(const WatchedWork&) = delete;

  void stop() { context_.cancel_group_execution(); }
  /// Waits a while for the work to be done; false when it is not yet.
  bool wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    return change_.wait_for(lock, kWatchInterval, [this] { return done_; });
  }
  /// Of the work, once it is done.
  std::exception_ptr failure() const { return failure_; }

 private:
  void run(const std::function<void()>& body) {
    std::exception_ptr failure;
    try {
      arena_.execute([&] {
        tbb::task_group group(context_);
        group.run_and_wait(body);
      });
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    failure_ = failure;
    done_ = true;
    change_.notify_one();
  }

  Arena arena_;
  tbb::task_group_context context_{tbb::task_group_context::isolated};
  std::mutex mutex_;  // of what follows
  std::condition_variable change_;
  bool done_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses the others
};

void run_watched(int threads, const std::function<void()>& body, const std::function<bool()>& watch) {
  WatchedWork work(threads, body);
  bool go_on = true;
  std::exception_ptr failure;
  do {
    if (!go_on) continue;
    try {
      go_on = watch();
    } catch (...) {
      go_on = false;
      failure = std::current_exception();
    }
    if (!go_on) work.stop();
  } while (!work.wait());
  if (failure) std::rethrow_exception(failure);
  if (!go_on) throw_cancelled();
  if (work.failure()) std::rethrow_exception(work.failure());
}

}  // namespace

void parallel_for(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
  if (count == 0) return;
  const tbb::blocked_range<size_t> all(0, count, std::max<size_t>(1, grain));
  hand_over([&](const auto& wrapped) { tbb::parallel_for(all, wrapped, tbb::simple_partitioner()); },
            [&](const tbb::blocked_range<size_t>& range) { body(range.begin(), range.end()); });
  throw_if_cancelled();  // TBB leaves out pieces, and says nothing
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  hand_over([&](const auto& wrapped) { tbb::parallel_invoke([&] { wrapped(a); }, [&] { wrapped(b); }); },
            [](const std::function<void()>& body) { body(); });
  throw_if_cancelled();
}

int thread_count() {
  return static_cast<int>(
      std::min<size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                       static_cast<size_t>(tbb::this_task_arena::max_concurrency())));
}

void with_threads(int threads, const std::function<void()>& body, const std::function<bool()>& watch) {
  const int here = thread_count();
  // Nobody has wished for anything where it is as many as the machine has.
  if (threads <= 0) threads = here == tbb::info::default_concurrency() ? machine_threads() : here;
  if (watch) return run_watched(threads, body, watch);
  if (threads == here) return body();
  Arena(threads).execute(body);
}

void throw_if_cancelled() {
  if (tbb::is_current_task_group_canceling()) throw_cancelled();
}

void isolate(const std::function<void()>& body) { tbb::this_task_arena::isolate(body); }

}  // namespace kairos
