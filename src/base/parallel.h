// Parallel loops: the only place of the library that sees TBB.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace kairos {

/// Calls body(begin, end) on disjoint pieces of [0, count) of at most `grain` (at least 1) elements, in parallel and in
/// no particular order. An exception thrown by a piece reaches the caller; pieces not begun by then are left out.
void parallel_for(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& body);

/// Runs both, perhaps at the same time.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

/// The number of threads that parallel loops use.
int thread_count();

/// While it lives, parallel loops of the process use at most `threads` threads (0: as many as the machine has).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Runs `body` so that a thread that waits inside it takes up no work from outside of it: around third-party code that
/// holds locks while it runs parallel loops of its own.
void isolate(const std::function<void()>& body);

}  // namespace kairos
