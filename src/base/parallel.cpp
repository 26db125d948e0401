#include "base/parallel.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

namespace kairos {

void parallel_for(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
  if (count == 0) return;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, std::max<size_t>(1, grain)),
      [&](const tbb::blocked_range<size_t>& range) { body(range.begin(), range.end()); }, tbb::simple_partitioner());
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) { tbb::parallel_invoke(a, b); }

int thread_count() {
  return static_cast<int>(
      std::min<size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                       static_cast<size_t>(tbb::this_task_arena::max_concurrency())));
}

struct ThreadLimit::State {
  std::unique_ptr<tbb::global_control> control;
};

ThreadLimit::ThreadLimit(int threads) : state_(std::make_unique<State>()) {
  if (threads > 0)
    state_->control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                            static_cast<size_t>(threads));
}
ThreadLimit::~ThreadLimit() = default;

void isolate(const std::function<void()>& body) { tbb::this_task_arena::isolate(body); }

}  // namespace kairos
