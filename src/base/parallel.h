// Parallel loops: the only place of the library that sees TBB.
//
// Loops use the threads of the arena that they run in: with_threads makes one. Arenas at the same time do not bind each
// other, and what is called inside one without a wish of its own stays inside.
#pragma once

#include <cstddef>
#include <functional>

namespace kairos {

/// Calls body(begin, end) on disjoint pieces of [0, count) of at most `grain` (at least 1) elements, in parallel and in
/// no particular order. An exception thrown by a piece reaches the caller; pieces not begun by then are left out.
/// Throws Error(cancelled) where with_threads has been told to stop.
void parallel_for(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& body);

/// Runs both, perhaps at the same time. Throws Error(cancelled) like parallel_for.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

/// The number of threads that parallel loops use here.
int thread_count();

/// Runs `body` so that parallel loops inside it use `threads` threads, which may be more than the machine has; 0: as
/// many as they would here.
///
/// watch: called by the calling thread, at once and about twenty times a second until `body` has returned, while others
/// do the work; when it returns false or throws, the work is stopped: parallel loops begin no further pieces, and
/// throw_if_cancelled throws. Then with_threads throws what `watch` did, or Error(cancelled). Without a watch the
/// calling thread does its part of the work.
void with_threads(int threads, const std::function<void()>& body, const std::function<bool()>& watch = {});

/// Throws Error(cancelled) where with_threads has been told to stop: for what takes long between parallel loops.
void throw_if_cancelled();

/// Runs `body` so that a thread that waits inside it takes up no work from outside of it: around third-party code that
/// holds locks while it runs parallel loops of its own.
void isolate(const std::function<void()>& body);

}  // namespace kairos
