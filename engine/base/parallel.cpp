#include "engine/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

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

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { work(i); });
}

}  // namespace engine
