#include "engine/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>

namespace engine {
namespace {

std::unique_ptr<tbb::global_control> thread_limit;  // lives as long as the process; set once by main

}  // namespace

void set_thread_count(unsigned threads) {
  thread_limit.reset();
  if (threads > 0)
    thread_limit =
        std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
}

unsigned thread_count() {
  const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const auto cores = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  return static_cast<unsigned>(std::max<std::size_t>(std::min(allowed, cores), 1));
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { work(i); });
}

}  // namespace engine
