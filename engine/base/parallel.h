// Parallel loops over numbered chunks. What a chunk computes depends on its number alone, so results do not
// depend on the thread count.
#pragma once

#include <cstddef>
#include <functional>

namespace engine {

/// Limits every later parallel loop of the process to `threads` (0: all cores). Call once, from main.
void set_thread_count(unsigned threads);

/// As many threads as a loop has at most.
unsigned thread_count();

/// Calls work(i) for each i in [0, count), in any order, from several threads; returns when all are done.
/// Exceptions of `work` reach the caller.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace engine
