// Time that only this process's own work takes: other programs at work beside it do not lengthen it much.
#pragma once

#include <ctime>

namespace engine {

/// Processor time of this process so far, all its threads, user and system  [s].
inline double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Seconds of it that `work` takes.
template <class Work>
double processor_seconds_of(Work&& work) {
  const double begin = processor_seconds();
  work();
  return processor_seconds() - begin;
}

}  // namespace engine
